#include "render/other_variants.h"

#include <mitsuba/core/config.h>
#include <mitsuba/core/logger.h>
#include <mitsuba/core/properties.h>

#include <set>
#include <sstream>
#include <string>

namespace mitsuba::culling {
namespace {

ref<Object> refuse(void*, const Properties& properties) {
    Throw(
        "%s renders in the variants scalar_rgb, scalar_spectral, llvm_ad_rgb and llvm_ad_spectral "
        "only, not in a mono, polarized or cuda variant",
        properties.plugin_name());
}

}  // namespace

void register_refusals(std::string_view name, PluginRegisterFn register_variant) {
    const std::set<std::string> rendering{"scalar_rgb", "scalar_spectral", "llvm_ad_rgb",
                                          "llvm_ad_spectral"};
    std::istringstream variants(MI_VARIANTS);
    for (std::string variant; variants >> variant;) {
        if (rendering.count(variant) == 0) {
            register_variant(name, variant, ObjectType::Integrator, refuse);
        }
    }
}

}  // namespace mitsuba::culling
