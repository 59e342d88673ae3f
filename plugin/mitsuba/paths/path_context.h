#pragma once

#include <lightcull/light_sampler.h>

#include <mitsuba/render/bsdf.h>
#include <mitsuba/render/integrator.h>

#include <cstdint>

#include "scene/scene_lights.h"

namespace mitsuba::culling {

template <typename Float, typename Spectrum>
class LightTables;

/// What the paths of one render have in common.
template <typename Float, typename Spectrum>
struct PathSetup {
    const Integrator<Float, Spectrum>* integrator = nullptr;
    const Scene<Float, Spectrum>* scene = nullptr;
    const SceneLights<Float, Spectrum>* lights = nullptr;
    const ::lightcull::LightSampler* selector = nullptr;
    const LightTables<Float, Spectrum>* tables = nullptr;  ///< of a wavefront only
    std::uint32_t max_depth = 0;                           ///< as of Mitsuba's `path`, all three
    std::uint32_t rr_depth = 0;
    bool hide_emitters = false;
    bool has_lobes = false;  ///< whether a surface has a glossy lobe to tell the selector of
};

/// The set of random ranges that a path uses at its camera point, and where those of its later
/// points start.
struct PathSets {
    std::uint32_t camera = 0;
    std::uint32_t packet = 0;

    /// At the point after `depth` bounces.
    std::uint32_t at(std::uint32_t depth, std::uint32_t set_count) const {
        return depth == 0 ? camera : ::lightcull::set_of_packet(packet + depth, set_count);
    }
};

/// The power heuristic; 0 where neither technique can.
template <typename Float>
Float mis_weight(const Float& pdf, const Float& other_pdf) {
    const Float a = dr::square(pdf), b = dr::square(other_pdf), weight = a / (a + b);
    return dr::select(dr::isfinite(weight), weight, 0.0f);
}

}  // namespace mitsuba::culling
