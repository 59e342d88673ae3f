#pragma once

#include <mitsuba/core/object.h>
#include <mitsuba/core/properties.h>

#include <string_view>

#include "arrays/variants.h"
#include "render/other_variants.h"

namespace mitsuba::culling {

/// Registers an integrator for each variant, and in all others a refusal.
template <template <typename, typename> class Integrator>
void register_integrator(std::string_view name, PluginRegisterFn register_plugin) {
#define REGISTER(Float, Spectrum)                                                       \
    register_plugin(name, Integrator<Float, Spectrum>::Variant, ObjectType::Integrator, \
                    [](void*, const Properties& properties) -> ref<Object> {            \
                        return new Integrator<Float, Spectrum>(properties);             \
                    });
    LIGHTCULL_VARIANTS(REGISTER)
#undef REGISTER
    register_refusals(name, register_plugin);
}

}  // namespace mitsuba::culling
