#include <lightcull/samplers.h>

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "base/random.h"

namespace lightcull {
namespace {

struct Vector {
    double x, y, z;
};
double dot(const Vector& a, const Vector& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
Vector unit(const Vector& v) {
    const double length = std::sqrt(dot(v, v));
    return {v.x / length, v.y / length, v.z / length};
}
float3 to_float3(const Vector& v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

/// A direction above the plane of a normal along z.
Vector upwards(RandomStream& random) {
    return unit({2.0 * random.next() - 1.0, 2.0 * random.next() - 1.0, 0.05 + random.next()});
}

/// GGX's D at the half vector of two directions, over that at the normal.
double ggx(const Vector& view, const Vector& light, double alpha) {
    const Vector h = unit({view.x + light.x, view.y + light.y, view.z + light.z});
    const double sine2 = h.x * h.x + h.y * h.y, cosine2 = h.z * h.z;
    const double a2 = alpha * alpha;
    return a2 * a2 / ((a2 * cosine2 + sine2) * (a2 * cosine2 + sine2));
}

}  // namespace

TEST_CASE("a glossy lobe is GGX's D at the half vector, from whatever side it is seen") {
    RandomStream random(3);
    double most_of_mirror_form = 0.0;
    for (int i = 0; i < 2000; ++i) {
        const double alpha = i % 2 == 0 ? 0.03 : 0.3;
        const Vector view = upwards(random), mirrored{-view.x, -view.y, view.z};
        // Two lights in the lobe, and the ratio of their probabilities.
        std::vector<Light> lights;
        double d[2], mirror_form[2];
        for (int k = 0; k < 2; ++k) {
            const Vector away = upwards(random);
            const Vector to = unit({mirrored.x + 4.0 * alpha * (away.x - 0.5) * view.z,
                                    mirrored.y + 4.0 * alpha * (away.y - 0.5) * view.z,
                                    mirrored.z + alpha * away.z * view.z});
            lights.push_back(point_light(to_float3({50 * to.x, 50 * to.y, 50 * to.z}), 1.0f));
            d[k] = ggx(view, to, alpha);
            const double f = 1.0 + 0.5 * (1.0 - dot(mirrored, to)) / (alpha * alpha);
            mirror_form[k] = 1.0 / (f * f);
        }
        ShadingPoint point;
        point.normal = {0, 0, 1};
        point.diffuse = 0.0f;
        point.lobe = {to_float3(mirrored), static_cast<float>(alpha), 1.0f};
        const auto sampler = make_sampler("exhaustive", lights);
        const double prob = double{sampler->prob(point, sampler->select(point, 0.5f).receipt, 0)};
        CHECK(prob / (1.0 - prob) == doctest::Approx(d[0] / d[1]).epsilon(1e-3));
        const double twin = mirror_form[0] / mirror_form[1] * d[1] / d[0];
        most_of_mirror_form = std::max(most_of_mirror_form, std::abs(twin - 1.0));
    }
    // The twin: a lobe about the mirror direction is not.
    CHECK(most_of_mirror_form > 2.0);
}

}  // namespace lightcull
