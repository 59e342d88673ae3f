#pragma once

#include <lightcull/triangle_cuts.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace mitsuba::culling {

/// How far from an emissive triangle the things are that it lights, by rays that have left it from
/// all over.
class LitDistances {
  public:
    struct Ray {
        ::lightcull::float2 from;  ///< barycentric coordinates
        float distance;            ///< metres; infinity: it met nothing
    };

    explicit LitDistances(std::vector<Ray> rays) : rays_(std::move(rays)) {}

    /// The distance to what a part lights, metres: most of what takes its light is not nearer.
    /// Infinity if it lights nothing.
    float from(const ::lightcull::SubTriangle& part) const {
        constexpr std::size_t kEnough = 12;
        constexpr double kNearer = 0.25;
        std::vector<float> distances;
        // A part from which too few rays have left takes those around it.
        for (int doubled = 0; doubled < kMostDoubled; ++doubled) {
            const float scale = std::ldexp(1.0f, doubled);
            std::size_t count = 0;
            distances.clear();
            for (const Ray& ray : rays_) {
                if (!holds(part, scale, ray.from)) continue;
                ++count;
                if (std::isfinite(ray.distance)) distances.push_back(ray.distance);
            }
            if (count >= kEnough) break;
        }
        if (distances.empty()) return std::numeric_limits<float>::infinity();
        const auto nth = distances.begin() + static_cast<std::ptrdiff_t>(
                                                 kNearer * static_cast<double>(distances.size()));
        std::nth_element(distances.begin(), nth, distances.end());
        return *nth;
    }

  private:
    static constexpr int kMostDoubled = 16;

    /// Whether the part holds a place, if it were larger about its middle.
    static bool holds(const ::lightcull::SubTriangle& part, float scale, ::lightcull::float2 at) {
        const auto [o, p, q] = part.corners;
        const float x = at.x - o.x, y = at.y - o.y;
        const float inverse = 1.0f / ::lightcull::area_share(part);
        const float second = (x * (q.y - o.y) - y * (q.x - o.x)) * inverse;
        const float third = ((p.x - o.x) * y - (p.y - o.y) * x) * inverse;
        const float least = (1.0f - scale) / 3.0f;
        return std::min({second, third, 1.0f - second - third}) >= least;
    }

    std::vector<Ray> rays_;
};

}  // namespace mitsuba::culling
