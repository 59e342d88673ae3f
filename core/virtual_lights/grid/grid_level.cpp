#include "virtual_lights/grid/grid_level.h"

#include "base/morton.h"
#include "base/parallel_blocks.h"
#include "lights/light/importance.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace lightcull {
namespace {

using Imath::V3d;
using Corners = std::array<LightMoments, 8>;

constexpr std::uint32_t kMostCells = 1022;  // cells along an edge, so that vertices have codes, too

struct Cell {
    std::uint32_t x, y, z;

    std::uint32_t vertex_code(std::uint32_t corner) const noexcept {
        return morton_code(x + (corner & 1u), y + (corner >> 1 & 1u), z + (corner >> 2));
    }
};

Cell cell_of(const V3f& place) noexcept {
    const auto index = [](float t) {
        return static_cast<std::uint32_t>(std::clamp(t, 0.0f, static_cast<float>(kMostCells)));
    };
    return {index(place.x), index(place.y), index(place.z)};
}

V3f place_in(const GridCells& cells, const LightMoments& light) noexcept {
    return (V3f(light.position / light.weight) - cells.origin) / cells.edge;
}

/// A run of some lights of a cell, in an order by cell, short enough for one thread.
struct Run {
    std::size_t begin, end;
};

std::vector<Run> runs_of(const std::vector<std::uint64_t>& keys) {
    constexpr std::size_t kLongest = 2048;
    std::vector<Run> runs;
    for (std::size_t i = 0; i < keys.size(); ++i) {
        const bool same = !runs.empty() && keys[i] >> 32 == keys[i - 1] >> 32 &&
                          runs.back().end - runs.back().begin < kLongest;
        if (!same) runs.push_back({i, i});
        runs.back().end = i + 1;
    }
    return runs;
}

void add_to_corners(const LightMoments& light, const V3f& place, const Cell& cell,
                    Corners& corners) noexcept {
    const V3d t(std::clamp(static_cast<double>(place.x) - cell.x, 0.0, 1.0),
                std::clamp(static_cast<double>(place.y) - cell.y, 0.0, 1.0),
                std::clamp(static_cast<double>(place.z) - cell.z, 0.0, 1.0));
    for (std::uint32_t c = 0; c < 8; ++c) {
        const double share = ((c & 1u) != 0 ? t.x : 1.0 - t.x) *
                             ((c >> 1 & 1u) != 0 ? t.y : 1.0 - t.y) *
                             ((c >> 2) != 0 ? t.z : 1.0 - t.z);
        if (share > 0.0) corners[c].add(light, share);
    }
}

}  // namespace

void LightMoments::add(const LightMoments& other, double share) noexcept {
    strength += other.strength * share;
    weight += other.weight * share;
    position += other.position * share;
    square += other.square * share;
    normal += other.normal * share;
}

LightMoments moments_of(const VirtualLight& light) noexcept {
    V3f strength = light.strength;
    if (light.lobe != Lobe::kDiffuse) {
        const float cosine = light.normal.dot(light.incoming);
        const V3f reflected = schlick(light.f0, cosine);
        strength *= light.lobe == Lobe::kUnderGloss
                        ? V3f(1.0f) - reflected
                        : reflected * (kInvPi / masking_over_two_cosines(cosine, light.alpha));
    }
    LightMoments m;
    m.strength = V3d(strength);
    m.weight = static_cast<double>(luminance(strength));
    const V3d position(light.position);
    m.position = position * m.weight;
    m.square = position * position * m.weight;
    m.normal = V3d(light.normal) * m.weight;
    return m;
}

GridLight light_of(const LightMoments& m) noexcept {
    const V3d position = m.position / m.weight;
    const V3d variance = m.square / m.weight - position * position;
    const auto deviation = [](double v) { return static_cast<float>(std::sqrt(std::max(0.0, v))); };
    return {V3f(position),
            {deviation(variance.x), deviation(variance.y), deviation(variance.z)},
            V3f(m.strength),
            V3f(m.normal / m.weight)};
}

V3f intensity(const GridLight& light, const V3f& outgoing) noexcept {
    const float spread = 0.25f * std::max(0.0f, 1.0f - light.normal.dot(light.normal));
    return light.strength * mean_above(light.normal.dot(outgoing), spread);
}

std::vector<LightMoments> scatter_to_vertices(const std::vector<LightMoments>& lights,
                                              const GridCells& cells) {
    constexpr std::size_t kBlock = 4096;
    std::vector<std::uint64_t> keys(lights.size());
    for_each_block(lights.size(), kBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Cell cell = cell_of(place_in(cells, lights[i]));
            keys[i] = std::uint64_t{cell.vertex_code(0)} << 32 | i;
        }
    });
    tbb::parallel_sort(keys.begin(), keys.end());

    // No two threads write to a vertex: each run has corners of its own, which are then gathered.
    const std::vector<Run> runs = runs_of(keys);
    std::vector<Corners> corners(runs.size());
    std::vector<std::uint64_t> vertices(8 * runs.size());
    for_each_block(runs.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t r = begin; r < end; ++r) {
            Cell cell{};
            for (std::size_t k = runs[r].begin; k < runs[r].end; ++k) {
                const LightMoments& light = lights[static_cast<std::uint32_t>(keys[k])];
                const V3f place = place_in(cells, light);
                cell = cell_of(place);
                add_to_corners(light, place, cell, corners[r]);
            }
            for (std::uint32_t c = 0; c < 8; ++c) {
                vertices[8 * r + c] = std::uint64_t{cell.vertex_code(c)} << 32 | (8 * r + c);
            }
        }
    });
    tbb::parallel_sort(vertices.begin(), vertices.end());

    std::size_t most = 0;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        most += i == 0 || vertices[i] >> 32 != vertices[i - 1] >> 32 ? 1 : 0;
    }
    std::vector<LightMoments> result;
    result.reserve(most);  // growth would hold it twice, beside all of the corners
    std::uint64_t last = 0;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const auto from = static_cast<std::uint32_t>(vertices[i]);
        const LightMoments& part = corners[from / 8][from % 8];
        if (!(part.weight > 0.0)) continue;
        const bool same = !result.empty() && last == vertices[i] >> 32;
        if (!same) result.emplace_back();
        last = vertices[i] >> 32;
        result.back().add(part, 1.0);
    }
    return result;
}

}  // namespace lightcull
