#pragma once

#include <lightcull/float3.h>

#include <mitsuba/render/emitter.h>
#include <mitsuba/render/mesh.h>
#include <mitsuba/render/shape.h>

#include <cstdint>
#include <vector>

namespace mitsuba::culling {

/// The mean radiance (luminance, W/(m^2 sr), >= 0) that leaves a surface on its two sides.
struct Emission {
    float front = 0.0f, back = 0.0f;
};

/// What a point emits in which directions: `peak` (luminance, W/sr) up to the angle `inner` from
/// `axis`, less from there to `outer`, and nothing beyond; both in radians.
struct PointEmission {
    ::lightcull::float3 position, axis{0, 0, 1};
    float peak = 0.0f, inner = 0.0f, outer = 0.0f;
};

/// What a directional emitter gives: irradiance (luminance, W/m^2) to a surface that faces it, and
/// the direction in which its light goes.
struct DirectionalEmission {
    ::lightcull::float3 direction;
    float irradiance = 0.0f;
};

/// The probe asks Mitsuba what an emitter emits. All estimates are by few samples, and only
/// selection rests on them.
template <typename Float, typename Spectrum>
class EmissionProbe {
  public:
    MI_IMPORT_TYPES(Emitter, Shape, Mesh)

    explicit EmissionProbe(const Emitter* emitter) : emitter_(emitter) {}

    /// The emission of each triangle of the emitter's mesh.
    std::vector<Emission> triangles(const Mesh* mesh) const;

    /// The radiance of some triangles of the emitter's mesh, the larger one of both sides, at the
    /// places of an EmissionLattice each.
    std::vector<float> lattices(const Mesh* mesh, const std::vector<std::uint32_t>& triangles,
                                std::uint32_t size) const;

    /// How many texels of the emitter's texture there are to a unit of texture coordinates, along
    /// the axis with more; 0 if it has none with texels.
    float texels() const;

    /// Whether the emission varies from place to place.
    bool varies() const { return has_flag(emitter_->flags(), EmitterFlags::SpatiallyVarying); }

    /// The emission of the emitter's shape, by points sampled on it.
    Emission shape() const;

    /// The emission of an emitter that is a point. Its peak is 0 if the probe found no light, and
    /// NaN if what it found is no number.
    PointEmission point() const;

    /// The emission of a directional emitter, as a point sees it.
    DirectionalEmission directional(const ScalarPoint3f& point) const;

    /// Whether samples that a point takes of an emitter without a place are numbers, and tell of
    /// the light that there is.
    bool can_be_sampled(const ScalarPoint3f& point) const;

  private:
    float mean_of_samples(const ScalarPoint3f& point) const;
    float mean_of_environment() const;

    const Emitter* emitter_;
};

}  // namespace mitsuba::culling
