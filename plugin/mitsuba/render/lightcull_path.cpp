#include <mitsuba/core/profiler.h>
#include <mitsuba/core/util.h>
#include <mitsuba/render/integrator.h>

#include <atomic>
#include <memory>
#include <string>
#include <utility>

#include "loop/trace_loop.h"
#include "paths/path_context.h"
#include "paths/progress_bar.h"
#include "render/caller_lights.h"
#include "render/errors_in_log.h"
#include "render/llvm_render_lock.h"
#include "render/loop_lights.h"
#include "render/register_integrator.h"
#include "render/render_task.h"
#include "sampler/range_sets.h"
#include "sampler/reusable_sampler.h"
#include "sampler/sampler_arena.h"
#include "sampler/sampler_cache.h"
#include "sampler/sampler_description.h"
#include "scalar/block_passes.h"
#include "scalar/trace_path.h"
#include "scene/calibration_points.h"
#include "scene/many_shapes_warning.h"
#include "scene/scene_lights.h"
#include "scene/surface_receiver.h"
#include "wavefront/trace_wavefront.h"
#include "wavefront/wavefront_passes.h"

namespace mitsuba::culling {
namespace {

/// The number of a pass for LightSampler::begin_pass(): other seeds draw other ranges.
std::uint64_t number_of_pass(std::uint32_t seed, std::uint32_t pass) {
    return (std::uint64_t{seed} << 32) | pass;
}

/// The seed as a number; in LLVM variants it is an array of one element.
template <typename UInt32>
std::uint32_t to_number(const UInt32& value) {
    if constexpr (dr::is_jit_v<UInt32>) {
        return dr::slice(value, 0);
    } else {
        return value;
    }
}

}  // namespace

/// The integrator `lightcull_path`: Mitsuba's `path`, with light selection by lightcull.
///
/// | parameter     | type    | meaning                                            | default   |
/// |---------------|---------|----------------------------------------------------|-----------|
/// | max_depth     | integer | longest path, edges: 1 shows emitters alone, 2     | -1        |
/// |               |         | adds direct light; -1: no limit                    |           |
/// | rr_depth      | integer | depth from which roulette may end a path, >= 1     | 5         |
/// | hide_emitters | boolean | the camera sees no emitter directly                | false     |
/// | block_size    | integer | side of the blocks that threads render, pixels,    | 0         |
/// |               |         | rounded up to a power of 2; 0: one that suits      |           |
/// |               |         | the threads. Of use in scalar variants             |           |
/// | timeout       | number  | seconds after which the render ends with what      | -1        |
/// |               |         | there is; negative: no limit                       |           |
/// | light_sampler | string  | how lights are chosen: a description as            | learned   |
/// |               |         | lightcull::parse_sampler() takes it, such as       |           |
/// |               |         | light_bvh:importance=means; culled where           |           |
/// |               |         | error_bound or sets are given                      |           |
/// | error_bound   | number  | error that the ranges of lights allow, > 0:        | auto      |
/// |               |         | epsilon_max of [TH16] Eq. 7; auto: calibrated on   |           |
/// |               |         | points of the scene. For culled                    |           |
/// | sets          | integer | sets of random ranges, a power of 4; by default as | 16 to 256 |
/// |               |         | many as suit the film and the lights. For culled   |           |
/// | keep_learned  | boolean | what the light sampler learns in a render serves   | false     |
/// |               |         | the next one, while lights and view are the same:  |           |
/// |               |         | images then depend on those before. For learned    |           |
///
/// `error_bound` and `sets` throw for a light sampler that has no such option. The parameter
/// samples_per_pass, which Mitsuba has deprecated, has no effect.
///
/// The integrator renders in passes over the whole film, and draws the random ranges of the lights
/// anew for each: an error that pixels have in common then falls with the number of passes. Where
/// the light sampler learns, passes are short, and each learns from the shadow rays of those
/// before.
///
/// Another integrator may call sample() as it does that of `path`, and in LLVM variants there are
/// derivatives by emission and materials, as of Mitsuba's `prb`. Lights are then chosen by
/// light_bvh:importance=means, whatever `light_sampler` says, since that needs no passes.
///
/// In LLVM variants a pass is one kernel, as with `path`, where the light sampler is
/// light_bvh:importance=means, or culled or learned with up to 64 lights, which are chosen among in
/// the same way. With any other, a bounce is two kernels, between which the processor chooses.
template <typename Float, typename Spectrum>
class LightcullPath final : public MonteCarloIntegrator<Float, Spectrum> {
  public:
    MI_IMPORT_BASE(MonteCarloIntegrator, should_stop, aov_names, render_sample, m_stop,
                   m_render_timer, m_hide_emitters, m_max_depth, m_rr_depth, m_block_size)
    MI_IMPORT_TYPES(Scene, Sensor, Film, ImageBlock, Medium, Sampler)

    explicit LightcullPath(const Properties& properties)
        : Base(properties),
          description_(sampler_description(properties)),
          asks_for_sampler_(properties.has_property("light_sampler") ||
                            properties.has_property("error_bound") ||
                            properties.has_property("sets")),
          keep_learned_(properties.get<bool>("keep_learned", false)) {
        // A wrong description is reported here, before there are lights.
        ReusableSampler({description_, {}, {}, 0});
    }

    TensorXf render(Scene* scene, Sensor* sensor, UInt32 seed, std::uint32_t spp, bool develop,
                    bool evaluate) override {
        return with_errors_in_log<Float>(
            [&] { return render_image(scene, sensor, seed, spp, develop, evaluate); });
    }

    /// Is what render() is, but for its errors.
    TensorXf render_image(Scene* scene, Sensor* sensor, UInt32 seed, std::uint32_t spp,
                          bool develop, bool evaluate) {
        ScopedPhase phase(ProfilerPhase::Render);
        m_stop = false;
        const auto lock = lock_llvm_render<Float>();
        m_render_timer.reset();
        if constexpr (dr::is_jit_v<Float>) warn_of_many_shapes(scene);

        const SceneLights<Float, Spectrum> lights(scene);
        Job job = make_job(scene, lights, sensor, seed, spp);
        const ScalarVector2u& size = job.size;
        Log(Info, "Starting render job (%ux%u, %u sample%s, %u lights by %s)", size.x(), size.y(),
            job.spp, job.spp == 1 ? "" : "s", lights.lights().size(), description_);
        if (kernel_chooses(lights)) {
            render_loops(job);
        } else {
            std::unique_ptr<ReusableSampler> reusable =
                take_light_sampler(scene, sensor, lights, size);
            job.light_sampler = reusable.get();
            job.context.light_sampler = &reusable->sampler();
            if (lights.lights().size() > 1) {
                job.context.vertex_culling = ::lightcull::vertex_culling(reusable->sampler());
            }
            if constexpr (dr::is_jit_v<Float>) {
                render_wavefronts(job);
            } else {
                render_blocks(job);
            }
            if (should_stop()) reusable->sampler().drop_reports();
            cache_.keep(std::move(reusable));
        }
        TensorXf image = finish(sensor->film(), develop, evaluate);
        if (!m_stop) {
            Log(Info, "Rendering finished. (took %s)",
                util::time_string(static_cast<float>(m_render_timer.value()), true));
        }
        return image;
    }

    std::pair<Spectrum, Mask> sample(const Scene* scene, Sampler* sampler,
                                     const RayDifferential3f& ray, const Medium*, Float*,
                                     Mask active) const override {
        if (m_max_depth == 0) return {0.0f, false};
        const auto* task = RenderTask<Float, Spectrum>::current();
        if (!task || task->context.integrator != this) {
            return with_errors_in_log<Float>(
                [&] { return sample_for_caller(scene, sampler, ray, active); });
        }
        if constexpr (dr::is_jit_v<Float>) {
            const auto& [passes, tables, bvh, derivation] = task->part;
            if (derivation) {
                return derivation->sample(task->context, sampler, ray, tables, *bvh, active);
            }
            if (bvh) return trace_loop(task->context, sampler, ray, tables, *bvh, active);
            return trace_wavefront(task->context, sampler, ray, passes.pass());
        } else {
            return trace_path(task->context, sampler, ray, task->part);
        }
    }

    TensorXf render_forward(Scene* scene, void*, Sensor* sensor, UInt32 seed,
                            std::uint32_t spp) override {
        TensorXf image;
        derive(scene, sensor, seed, spp, [&](const Job& job, auto& passes, const auto& loop) {
            const Derivation<Float, Spectrum> forward{Derivation<Float, Spectrum>::kForward, 0.0f};
            render_passes(job, passes, {passes, loop.tables, &loop.bvh, &forward},
                          [](std::uint32_t) {});
            image = finish(sensor->film(), true, true);
        });
        return image;
    }
    void render_backward(Scene* scene, void*, const TensorXf& gradient, Sensor* sensor, UInt32 seed,
                         std::uint32_t spp) override {
        derive(scene, sensor, seed, spp, [&](const Job& job, auto& passes, const auto& loop) {
            // All passes have as many samples.
            const Float share = dr::detach(gradient.array()) / static_cast<float>(passes.count());
            for (std::uint32_t pass = 0; pass < passes.count() && !should_stop(); ++pass) {
                derive_backward(job, passes, loop, share);
                passes.advance();
            }
            sensor->film()->clear();
        });
    }

    std::string to_string() const override {
        return tfm::format(
            "LightcullPath[\n  max_depth = %u,\n  rr_depth = %u,\n"
            "  light_sampler = %s\n]",
            m_max_depth, m_rr_depth, description_);
    }

    MI_DECLARE_CLASS(LightcullPath)

  private:
    /// What a render under way is about.
    struct Job {
        PathContext<Float, Spectrum> context;
        const ReusableSampler* light_sampler;  ///< null: the kernel chooses
        Sensor* sensor;
        ScalarVector2u size;  ///< pixels that get samples, with those of the border
        std::size_t channels;
        std::uint32_t seed, spp;
    };

    /// The size of what gets samples, with the border (pixels).
    static ScalarVector2u sampled_size(const Film* film) {
        ScalarVector2u size = film->crop_size();
        if (film->sample_border()) size += 2 * film->rfilter()->border_size();
        return size;
    }

    Job make_job(const Scene* scene, const SceneLights<Float, Spectrum>& lights, Sensor* sensor,
                 const UInt32& seed, std::uint32_t spp) const {
        if (spp != 0) sensor->sampler()->set_sample_count(spp);
        return {context(scene, lights, has_glossy_surfaces(scene)),
                nullptr,
                sensor,
                sampled_size(sensor->film()),
                sensor->film()->prepare(aov_names()),
                to_number(seed),
                sensor->sampler()->sample_count()};
    }

    /// The context of paths among whose lights the kernel chooses.
    PathContext<Float, Spectrum> context(const Scene* scene,
                                         const SceneLights<Float, Spectrum>& lights,
                                         bool has_lobes) const {
        return {this, scene, &lights, nullptr, m_max_depth, m_rr_depth, m_hide_emitters, has_lobes};
    }

    /// Traces paths for whoever asks, as another integrator does around this one. Nobody tells of
    /// passes then, and lights are chosen as `kMeans` says, which needs none.
    std::pair<Spectrum, Mask> sample_for_caller(const Scene* scene, Sampler* sampler,
                                                const RayDifferential3f& ray, Mask active) const {
        if constexpr (dr::is_jit_v<Float>) {
            if (jit_flag(JitFlag::SymbolicScope)) {
                Throw(
                    "lightcull_path cannot look at the lights of the scene within a symbolic loop "
                    "or call: call sample() outside of it, or make it mode=\"evaluated\"");
            }
            const dr::suspend_grad<Float> no_derivatives;
            const auto lock = lock_llvm_render<Float>();
            const SceneLights<Float, Spectrum> lights(scene);
            say_what_chooses(lights);
            const PathContext<Float, Spectrum> paths =
                context(scene, lights, has_glossy_surfaces(scene));
            const LoopLights<Float, Spectrum> loop(scene, lights, paths.has_lobes);
            return trace_loop(paths, sampler, ray, loop.tables, loop.bvh, active);
        } else {
            if (!active) return {0.0f, false};
            const auto& known = caller_lights_.of(scene, sampler);
            say_what_chooses(known.lights);
            PathContext<Float, Spectrum> path = context(scene, known.lights, known.has_lobes);
            path.light_sampler = &known.light_sampler->sampler();
            return trace_path(path, sampler, ray, PathSets());
        }
    }

    /// Calls function(job, passes, lights of the loop) to compute derivatives.
    template <typename Function>
    void derive(Scene* scene, Sensor* sensor, const UInt32& seed, std::uint32_t spp,
                const Function& function) {
        if constexpr (dr::is_jit_v<Float>) {
            with_errors_in_log<Float>([&] {
                refuse_moving_shapes(scene);
                m_stop = false;
                const dr::suspend_grad<Float> no_derivatives;
                const auto lock = lock_llvm_render<Float>();
                m_render_timer.reset();
                const SceneLights<Float, Spectrum> lights(scene);
                say_what_chooses(lights);
                const Job job = make_job(scene, lights, sensor, seed, spp);
                const LoopLights<Float, Spectrum> loop(scene, lights, job.context.has_lobes);
                WavefrontPasses<Float, Spectrum> passes(sensor, job.size, job.seed, job.spp, {},
                                                        loop.tables, memory_);
                function(job, passes, loop);
            });
        } else {
            Throw("lightcull_path has derivatives in llvm_ad variants");
        }
    }

    /// Adds to the gradients of the scene what a pass has of them, by the gradient of the image.
    template <typename Passes>
    void derive_backward(const Job& job, Passes& passes, const LoopLights<Float, Spectrum>& loop,
                         const Float& gradient) const {
        using Step = Derivation<Float, Spectrum>;
        const std::unique_ptr<Float[]> channels(new Float[job.channels]);
        Step step{Step::kSplat, dr::full<Spectrum>(1.0f, dr::width(passes.corners()))};
        const LanePaths<Float, Spectrum> paths{passes, loop.tables, &loop.bvh, &step};
        const RenderTask<Float, Spectrum> task(job.context, paths);
        const auto render = [&](Sampler* sampler, ImageBlock* block) {
            render_sample(job.context.scene, job.sensor, sampler, block, channels.get(),
                          passes.corners(), dr::rsqrt(static_cast<float>(job.spp)));
        };
        ref<Sampler> same_numbers = passes.sampler()->clone();
        {
            const dr::resume_grad<Float> derivatives;
            dr::enable_grad(step.change);
            Film* film = job.sensor->film();
            ref<ImageBlock> block = film->create_block();
            block->set_offset(film->crop_offset());
            block->set_coalesce(passes.block()->coalesce());
            render(same_numbers.get(), block.get());
            film->clear();
            film->put_block(block);
            TensorXf image = film->develop();
            dr::set_grad(image.array(), gradient);
            dr::enqueue(dr::ADMode::Backward, image.array());
            dr::traverse(dr::ADMode::Backward);
            step.change = dr::grad(step.change);
        }
        step.step = Step::kBackward;
        render(passes.sampler(), passes.block());
        dr::eval();
    }

    /// Says once if lights are not chosen as `light_sampler` asks.
    void say_what_chooses(const SceneLights<Float, Spectrum>& lights) const {
        if (said_what_chooses_ || said_what_chooses_.exchange(true)) return;
        if (chooses_by_means(description_, lights.lights().size(), lights.uncut_count())) return;
        Log(asks_for_sampler_ ? Warn : Info,
            "lightcull_path: within another integrator and for derivatives, %s chooses lights, not "
            "%s, which needs passes",
            kMeans, description_);
    }

    /// The light sampler of the last render if it was made from the same, else a new one.
    std::unique_ptr<ReusableSampler> take_light_sampler(const Scene* scene, const Sensor* sensor,
                                                        const SceneLights<Float, Spectrum>& lights,
                                                        const ScalarVector2u& size) {
        SamplerInput input{description_, lights.lights(),
                           calibration_points<Float, Spectrum>(scene, sensor), size.x() * size.y()};
        std::unique_ptr<ReusableSampler> reusable = cache_.take();
        if (reusable && reusable->is_made_from(input)) {
            Log(Info, "The light sampler of the last render serves again");
            // What was learned stays with its render: an image depends on scene and seed alone.
            if (!keep_learned_) reusable->forget();
            return reusable;
        }
        in_sampler_arena([&] { reusable = std::make_unique<ReusableSampler>(std::move(input)); });
        return reusable;
    }

    /// Whether lights are chosen within Dr.Jit's kernel.
    bool kernel_chooses(const SceneLights<Float, Spectrum>& lights) const {
        return dr::is_jit_v<Float> &&
               chooses_by_means(description_, lights.lights().size(), lights.uncut_count());
    }

    void render_blocks(const Job& job) {
        if constexpr (!dr::is_jit_v<Float>) {
            using Passes = BlockPasses<Float, Spectrum>;
            ::lightcull::LightSampler& light_sampler = job.light_sampler->sampler();
            const std::uint32_t range_sets = light_sampler.set_count();
            Passes passes(job.sensor, job.size, job.channels, m_block_size, job.seed, job.spp,
                          range_sets, job.light_sampler->learns());
            const float differential_scale = dr::rsqrt(static_cast<float>(job.spp));
            for (std::uint32_t pass = 0; pass < passes.count() && !should_stop(); ++pass) {
                in_sampler_arena([&] { light_sampler.begin_pass(number_of_pass(job.seed, pass)); });
                passes.run(
                    pass,
                    [&](const typename Passes::Pixel& pixel, Sampler* sampler, ImageBlock* block,
                        Float* channels) {
                        const PathSets sets =
                            sets_of_sample(pixel.x, pixel.y, pixel.sample, range_sets);
                        const RenderTask<Float, Spectrum> task(job.context, sets);
                        render_sample(job.context.scene, job.sensor, sampler, block, channels,
                                      pixel.corner, differential_scale);
                    },
                    [&] { return should_stop(); });
            }
        }
    }

    void render_wavefronts(const Job& job) {
        if constexpr (dr::is_jit_v<Float>) {
            const dr::suspend_grad<Float> no_derivatives;
            ::lightcull::LightSampler& light_sampler = job.light_sampler->sampler();
            const LightTables<Float, Spectrum> tables(job.context.scene, *job.context.lights);
            WavefrontPasses<Float, Spectrum> passes(
                job.sensor, job.size, job.seed, job.spp,
                {light_sampler.set_count(), job.light_sampler->learns(), false}, tables, memory_);
            render_passes(job, passes, {passes, tables, nullptr}, [&](std::uint32_t pass) {
                light_sampler.begin_pass(number_of_pass(job.seed, pass));
            });
        } else {
            DRJIT_MARK_USED(job);
        }
    }

    void render_loops(const Job& job) {
        if constexpr (dr::is_jit_v<Float>) {
            const dr::suspend_grad<Float> no_derivatives;
            const LoopLights<Float, Spectrum> loop(job.context.scene, *job.context.lights,
                                                   job.context.has_lobes);
            WavefrontPasses<Float, Spectrum> passes(job.sensor, job.size, job.seed, job.spp, {},
                                                    loop.tables, memory_);
            render_passes(job, passes, {passes, loop.tables, &loop.bvh}, [](std::uint32_t) {});
        } else {
            DRJIT_MARK_USED(job);
        }
    }

    /// Renders in passes, before each of which it calls begin(number of the pass).
    template <typename Passes, typename Begin>
    void render_passes(const Job& job, Passes& passes, const LanePaths<Float, Spectrum>& paths,
                       const Begin& begin) {
        const RenderTask<Float, Spectrum> task(job.context, paths);
        const float differential_scale = dr::rsqrt(static_cast<float>(job.spp));
        const std::unique_ptr<Float[]> channels(new Float[job.channels]);
        ProgressBar progress(passes.count());
        for (std::uint32_t pass = 0; pass < passes.count() && !should_stop(); ++pass) {
            in_sampler_arena([&] {
                begin(pass);
                render_sample(job.context.scene, job.sensor, passes.sampler(), passes.block(),
                              channels.get(), passes.corners(), differential_scale);
            });
            passes.advance();
            progress.step();
        }
        passes.finish();
    }

    /// The film's image if it is to be developed.
    TensorXf finish(Film* film, bool develop, bool evaluate) const {
        TensorXf image;
        if (develop) image = film->develop();
        if constexpr (dr::is_jit_v<Float>) {
            if (develop) {
                dr::schedule(image);
            } else {
                film->schedule_storage();
            }
            if (evaluate) {
                dr::eval();
                dr::sync_thread();
            }
        } else {
            DRJIT_MARK_USED(film);
            DRJIT_MARK_USED(evaluate);
        }
        return image;
    }

    std::string description_;
    bool asks_for_sampler_;  ///< it is not the default that description_ is
    bool keep_learned_;
    SamplerCache cache_;
    mutable CallerLights<Float, Spectrum> caller_lights_;
    mutable std::atomic<bool> said_what_chooses_ = false;
    LaneMemory memory_;  // of the render that holds the lock
};

}  // namespace mitsuba::culling

extern "C" MI_EXPORT void init_plugin(std::string_view name,
                                      mitsuba::PluginRegisterFn register_plugin) {
    mitsuba::culling::register_integrator<mitsuba::culling::LightcullPath>(name, register_plugin);
}
