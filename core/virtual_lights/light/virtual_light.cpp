#include "virtual_lights/light/virtual_light.h"

namespace lightcull {

void add_virtual_lights(const Surface& surface, const V3f& incoming, const V3f& flux,
                        std::vector<VirtualLight>& lights) {
    const Bsdf& bsdf = surface.bsdf;
    const V3f& normal = bsdf.normal();
    const V3f diffuse = flux * bsdf.diffuse_albedo() * kInvPi;
    if (max_component(diffuse) > 0.0f) {
        lights.push_back({surface.origin, normal, incoming, diffuse, bsdf.f0(), 1.0f,
                          bsdf.is_specular() ? Lobe::kUnderGloss : Lobe::kDiffuse});
    }
    if (!bsdf.is_specular() || !(max_component(flux) > 0.0f)) return;
    const float masking = masking_over_two_cosines(normal.dot(incoming), bsdf.alpha());
    lights.push_back(
        {surface.origin, normal, incoming, flux * masking, bsdf.f0(), bsdf.alpha(), Lobe::kGlossy});
}

}  // namespace lightcull
