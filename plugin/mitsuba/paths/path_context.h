#pragma once

#include <lightcull/light_sampler.h>
#include <lightcull/samplers.h>

#include <mitsuba/render/integrator.h>
#include <mitsuba/render/scene.h>

#include <cstdint>

#include "scene/scene_lights.h"

namespace mitsuba::culling {

/// What the paths of one render have in common.
template <typename Float, typename Spectrum>
struct PathContext {
    const Integrator<Float, Spectrum>* integrator = nullptr;
    const Scene<Float, Spectrum>* scene = nullptr;
    const SceneLights<Float, Spectrum>* lights = nullptr;
    const ::lightcull::LightSampler* light_sampler = nullptr;  ///< null: the kernel chooses
    std::uint32_t max_depth = 0;  ///< this and the next two mean what they mean to Mitsuba's `path`
    std::uint32_t rr_depth = 0;
    bool hide_emitters = false;
    bool has_lobes = false;  ///< whether a surface has a glossy lobe to tell light_sampler of
    /// What the light sampler asks of its host, as `paper` does; null: nothing.
    const ::lightcull::VertexCulling* vertex_culling = nullptr;
};

}  // namespace mitsuba::culling
