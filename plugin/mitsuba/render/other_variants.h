#pragma once

#include <mitsuba/core/object.h>

#include <string_view>

namespace mitsuba::culling {

/// Registers, for the variants that cannot render, a plugin that says so.
void register_refusals(std::string_view name, PluginRegisterFn register_variant);

}  // namespace mitsuba::culling
