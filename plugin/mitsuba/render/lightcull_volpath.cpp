#include <mitsuba/render/integrator.h>

#include <string_view>
#include <utility>

#include "paths/path_context.h"
#include "render/caller_lights.h"
#include "render/errors_in_log.h"
#include "render/llvm_render_lock.h"
#include "render/loop_lights.h"
#include "render/register_integrator.h"
#include "scene/many_shapes_warning.h"
#include "scene/scene_lights.h"
#include "scene/surface_receiver.h"
#include "volume/scene_media.h"
#include "volume/trace_volume.h"

namespace mitsuba::culling {

/// The integrator `lightcull_volpath`: Mitsuba's `volpath`, with light selection by lightcull.
///
/// | parameter     | type    | meaning                                            | default   |
/// |---------------|---------|----------------------------------------------------|-----------|
/// | max_depth     | integer | longest path, edges: 1 shows emitters alone, 2     | -1        |
/// |               |         | adds direct light; -1: no limit. What lets a path  |           |
/// |               |         | straight through does not count                    |           |
/// | rr_depth      | integer | depth from which roulette may end a path, >= 1     | 5         |
/// | hide_emitters | boolean | the camera sees no emitter directly                | false     |
/// | block_size    | integer | side of the blocks that threads render, pixels,    | 0         |
/// |               |         | rounded up to a power of 2; 0: one that suits      |           |
/// |               |         | the threads. Of use in scalar variants             |           |
/// | timeout       | number  | seconds after which the render ends with what      | -1        |
/// |               |         | there is; negative: no limit                       |           |
///
/// Lights are chosen by light_bvh:importance=means, which needs no passes: for points on surfaces
/// as lightcull_path does, for points in media by distance and emission alone. Another integrator
/// may call sample() as it does that of `volpath`. In LLVM variants a render is one kernel. There
/// are no derivatives: Mitsuba's `prbvolpath` has them.
///
/// Unlike `volpath`, whose shadow rays may hit the light that they are aimed at once they have
/// passed a surface that lets them through, it loses no light there; and homogeneous media have
/// their transmittance in place of a sample of it.
template <typename Float, typename Spectrum>
class LightcullVolpath final : public MonteCarloIntegrator<Float, Spectrum> {
  public:
    MI_IMPORT_BASE(MonteCarloIntegrator, m_hide_emitters, m_max_depth, m_rr_depth)
    MI_IMPORT_TYPES(Scene, Sensor, Medium, Sampler)

    explicit LightcullVolpath(const Properties& properties) : Base(properties) {}

    TensorXf render(Scene* scene, Sensor* sensor, UInt32 seed, std::uint32_t spp, bool develop,
                    bool evaluate) override {
        if constexpr (dr::is_jit_v<Float>) {
            warn_of_many_shapes(scene);
            const dr::suspend_grad<Float> no_derivatives;
            return Base::render(scene, sensor, seed, spp, develop, evaluate);
        } else {
            const auto known = caller_lights_.hold(scene);
            return Base::render(scene, sensor, seed, spp, develop, evaluate);
        }
    }

    std::pair<Spectrum, Mask> sample(const Scene* scene, Sampler* sampler,
                                     const RayDifferential3f& ray, const Medium* medium, Float*,
                                     Mask active) const override {
        if (m_max_depth == 0) return {0.0f, false};
        return with_errors_in_log<Float>(
            [&] { return sample_volume(scene, sampler, ray, medium, active); });
    }

    TensorXf render_forward(Scene*, void*, Sensor*, UInt32, std::uint32_t) override {
        refuse_derivatives();
    }
    void render_backward(Scene*, void*, const TensorXf&, Sensor*, UInt32, std::uint32_t) override {
        refuse_derivatives();
    }

    std::string to_string() const override {
        return tfm::format("LightcullVolpath[\n  max_depth = %u,\n  rr_depth = %u\n]", m_max_depth,
                           m_rr_depth);
    }

    MI_DECLARE_CLASS(LightcullVolpath)

  private:
    [[noreturn]] static void refuse_derivatives() {
        with_errors_in_log<Float>(
            [] { Throw("lightcull_volpath has no derivatives: Mitsuba's prbvolpath has them"); });
        std::abort();
    }

    PathContext<Float, Spectrum> context(const Scene* scene,
                                         const SceneLights<Float, Spectrum>& lights,
                                         bool has_lobes) const {
        return {this, scene, &lights, nullptr, m_max_depth, m_rr_depth, m_hide_emitters, has_lobes};
    }

    std::pair<Spectrum, Mask> sample_volume(const Scene* scene, Sampler* sampler,
                                            const RayDifferential3f& ray, const Medium* medium,
                                            const Mask& active) const {
        if constexpr (dr::is_jit_v<Float>) {
            if (jit_flag(JitFlag::SymbolicScope)) {
                Throw(
                    "lightcull_volpath cannot look at the lights of the scene within a symbolic "
                    "loop or call: call sample() outside of it, or make it mode=\"evaluated\"");
            }
            const dr::suspend_grad<Float> no_derivatives;
            const auto lock = lock_llvm_render<Float>();
            const SceneLights<Float, Spectrum> lights(scene);
            const auto paths = context(scene, lights, has_glossy_surfaces(scene));
            const LoopLights<Float, Spectrum> loop(scene, lights, paths.has_lobes);
            return trace_volume(paths, {paths, loop.tables, loop.bvh}, SceneMedia(scene), medium,
                                sampler, ray, active);
        } else {
            if (!active) return {0.0f, false};
            const auto held = caller_lights_.held(scene);
            const auto& known = held ? *held : caller_lights_.of(scene, sampler);
            auto path = context(scene, known.lights, known.has_lobes);
            path.light_sampler = &known.light_sampler->sampler();
            return trace_volume(path, VolumeLights<Float, Spectrum>(path), known.media, medium,
                                sampler, ray, active);
        }
    }

    mutable CallerLights<Float, Spectrum> caller_lights_;
};

}  // namespace mitsuba::culling

extern "C" MI_EXPORT void init_plugin(std::string_view name,
                                      mitsuba::PluginRegisterFn register_plugin) {
    mitsuba::culling::register_integrator<mitsuba::culling::LightcullVolpath>(name,
                                                                              register_plugin);
}
