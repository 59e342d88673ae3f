#pragma once

#include <cstdint>

#include "scene/triangle_places.h"

namespace mitsuba::culling {

/// Draws a place on a light that is a triangle, or a part of one, in scalar variants.
template <typename Sampler>
TrianglePlaces::Place draw_place(const TrianglePlaces& places, std::uint32_t light,
                                 Sampler* sampler) {
    double of_piece = 0.0;
    if (places.part(light) != TrianglePlaces::kNone) {
        // The second number gives digits that the first does not have.
        of_piece = static_cast<double>(sampler->next_1d());
        of_piece += 0x1p-24 * static_cast<double>(sampler->next_1d());
    }
    const auto random = sampler->next_2d();
    return places.draw(light, of_piece, random.x(), random.y());
}

}  // namespace mitsuba::culling
