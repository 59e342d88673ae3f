#pragma once

#include <lightcull/light_bvh_table.h>

#include "lanes/light_tables.h"
#include "loop/light_bvh_arrays.h"
#include "sampler/sampler_arena.h"
#include "scene/scene_lights.h"

namespace mitsuba::culling {

/// The lights of a scene as a loop within the kernel chooses among them.
template <typename Float, typename Spectrum>
struct LoopLights {
    LoopLights(const Scene<Float, Spectrum>* scene, const SceneLights<Float, Spectrum>& lights,
               bool has_lobes)
        : tables(scene, lights), bvh(make_table(lights), has_lobes) {}

    LightTables<Float, Spectrum> tables;
    LightBvhArrays<Float> bvh;

  private:
    static ::lightcull::LightBvhTable make_table(const SceneLights<Float, Spectrum>& lights) {
        ::lightcull::LightBvhTable table;
        if (lights.lights().size() > 1) {
            in_sampler_arena([&] { table = ::lightcull::make_light_bvh_table(lights.lights()); });
        }
        return table;
    }
};

}  // namespace mitsuba::culling
