#pragma once

#include <mitsuba/core/object.h>

#include <string_view>

namespace mitsuba::culling {

/// Registers, for each variant of Mitsuba in which lightcull's cannot render, a plugin that
/// throws and says so.
void register_refusals(std::string_view name, PluginRegisterFn register_variant);

}  // namespace mitsuba::culling
