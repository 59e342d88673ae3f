#pragma once

#include <lightcull/triangle_cuts.h>

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace mitsuba::culling {

/// Where places are sampled on the lights that are triangles, or parts of triangles that are cut.
/// Places are barycentric coordinates in the whole triangle.
class TrianglePlaces {
  public:
    static constexpr std::uint32_t kNone = 0xffffffffu;

    struct Place {
        ::lightcull::float2 uv;
        float density;  ///< by area, 1/m^2
    };
    /// The light that a place belongs to, and the density with which the place is sampled on it.
    struct Found {
        std::uint32_t light;
        float density;  ///< by area, 1/m^2; 0: it is not
    };

    /// Adds the next light: a triangle of an area (m^2), or something else, of area 0.
    void add(float area) { lights_.push_back({area, kNone, kNone}); }

    /// Takes the triangles that may be cut.
    void take(::lightcull::TriangleCuts cuts) {
        cuts_ = std::move(cuts);
        light_of_part_.assign(cuts_.parts().size(), kNone);
    }
    /// Says which light is the first part of a triangle of the cuts.
    void set_triangle(std::uint32_t light, std::uint32_t triangle) {
        lights_[light].triangle = triangle;
    }
    /// Says which light a part is.
    void set_part(std::uint32_t light, std::uint32_t part) {
        lights_[light].part = part;
        light_of_part_[part] = light;
    }

    const ::lightcull::TriangleCuts& cuts() const { return cuts_; }
    /// The area of the whole triangle.
    float area(std::uint32_t light) const { return lights_[light].area; }
    /// The part that a light is; kNone: all of its triangle.
    std::uint32_t part(std::uint32_t light) const { return lights_[light].part; }
    /// The triangle of the cuts that a light is the first part of; kNone: none.
    std::uint32_t triangle(std::uint32_t light) const { return lights_[light].triangle; }
    std::uint32_t light_of_part(std::uint32_t part) const { return light_of_part_[part]; }
    bool has_parts() const {
        return std::any_of(light_of_part_.begin(), light_of_part_.end(),
                           [](std::uint32_t light) { return light != kNone; });
    }

    /// Draws a place on a light that is a triangle, by numbers in [0, 1).
    Place draw(std::uint32_t light, double of_piece, float u, float v) const {
        const Light& of = lights_[light];
        ::lightcull::TriangleCuts::Piece piece{0, 1.0f, {}, {1.0f, 1.0f, 1.0f}};
        if (of.part != kNone) piece = cuts_.draw(of.part, of_piece);
        const ::lightcull::float2 place = ::lightcull::TriangleCuts::draw_place(piece, u, v);
        return {::lightcull::place_in(piece.corners, place), density(piece, place, of.area)};
    }

    /// Finds a place of a triangle again, by the light that is the triangle or its first part.
    Found find(std::uint32_t light, ::lightcull::float2 uv) const {
        const Light& of = lights_[light];
        if (of.triangle == kNone) return {light, 1.0f / of.area};
        const auto [piece, place] = cuts_.at(of.triangle, uv);
        if (piece.part == ::lightcull::TriangleCuts::kNoPart) return {light, 0.0f};
        return {light_of_part_[piece.part], density(piece, place, of.area)};
    }

  private:
    struct Light {
        float area;
        std::uint32_t part, triangle;
    };

    static float density(const ::lightcull::TriangleCuts::Piece& piece, ::lightcull::float2 place,
                         float area) {
        return piece.prob * ::lightcull::TriangleCuts::density(piece, place) /
               (::lightcull::area_share(piece.corners) * area);
    }

    ::lightcull::TriangleCuts cuts_;
    std::vector<Light> lights_;
    std::vector<std::uint32_t> light_of_part_;
};

}  // namespace mitsuba::culling
