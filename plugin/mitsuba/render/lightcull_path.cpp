#include <mitsuba/core/profiler.h>
#include <mitsuba/core/util.h>
#include <mitsuba/render/integrator.h>
#include <nanothread/nanothread.h>
#include <tbb/task_arena.h>

#include <memory>
#include <string>
#include <utility>

#include "arrays/variants.h"
#include "render/llvm_render_lock.h"
#include "render/other_variants.h"
#include "render/render_task.h"
#include "sampler/reusable_sampler.h"
#include "sampler/sampler_cache.h"
#include "sampler/sampler_description.h"
#include "scalar/block_passes.h"
#include "scalar/scalar_path.h"
#include "scene/calibration_points.h"
#include "scene/many_shapes_warning.h"
#include "scene/scene_lights.h"
#include "scene/surface_receiver.h"
#include "wavefront/light_tables.h"
#include "wavefront/wavefront.h"
#include "wavefront/wavefront_passes.h"

namespace mitsuba::culling {
namespace {

/// Runs it with as many threads as Mitsuba uses. An arena for each thread that calls: in one that
/// is full, another thread would run the function. It is kept, since TBB never frees all of one.
template <typename Function>
void in_arena(const Function& function) {
    thread_local std::unique_ptr<tbb::task_arena> arena;
    const auto threads = static_cast<int>(pool_size());
    if (!arena || arena->max_concurrency() != threads) {
        arena = std::make_unique<tbb::task_arena>(threads);
    }
    arena->execute(function);
}

std::uint64_t number_of_pass(std::uint32_t seed, std::uint32_t pass) {
    return (std::uint64_t{seed} << 32) | pass;
}

template <typename UInt32>
std::uint32_t to_number(const UInt32& value) {
    if constexpr (dr::is_jit_v<UInt32>) {
        return dr::slice(value, 0);
    } else {
        return value;
    }
}

}  // namespace

/// Mitsuba's `path`, with light selection by lightcull. Its parameters are those of `path` and the
/// ones of sampler_description().
///
/// It renders in passes over the whole film, and the random ranges of the lights are drawn anew for
/// each: an error that pixels have in common then falls with the number of passes.
template <typename Float, typename Spectrum>
class LightcullPath final : public MonteCarloIntegrator<Float, Spectrum> {
  public:
    MI_IMPORT_BASE(MonteCarloIntegrator, should_stop, aov_names, render_sample, m_stop,
                   m_render_timer, m_hide_emitters, m_max_depth, m_rr_depth, m_block_size)
    MI_IMPORT_TYPES(Scene, Sensor, Film, ImageBlock, Medium, Sampler)

    explicit LightcullPath(const Properties& properties)
        : Base(properties), description_(sampler_description(properties)) {
        // What is wrong in the description is so before there are lights.
        MadeSampler({description_, {}, {}, 0});
    }

    TensorXf render(Scene* scene, Sensor* sensor, UInt32 seed, std::uint32_t spp, bool develop,
                    bool evaluate) override {
        ScopedPhase phase(ProfilerPhase::Render);
        m_stop = false;
        const auto turn = take_turn<Float>();
        m_render_timer.reset();
        if (spp != 0) sensor->sampler()->set_sample_count(spp);
        if constexpr (dr::is_jit_v<Float>) warn_of_many_shapes(scene);

        const SceneLights<Float, Spectrum> lights(scene);
        const ScalarVector2u size = sampled_size(sensor->film());
        std::unique_ptr<MadeSampler> made = make_selector(scene, sensor, lights, size);
        const Job job{{this, scene, &lights, &made->sampler(), nullptr, m_max_depth, m_rr_depth,
                       m_hide_emitters, has_glossy_surfaces(scene)},
                      made->sampler(),
                      sensor,
                      size,
                      sensor->film()->prepare(aov_names()),
                      to_number(seed),
                      sensor->sampler()->sample_count()};
        Log(Info, "Starting render job (%ux%u, %u sample%s, %u lights by %s)", size.x(), size.y(),
            job.spp, job.spp == 1 ? "" : "s", lights.lights().size(), description_);
        if constexpr (dr::is_jit_v<Float>) {
            render_wavefronts(job);
        } else {
            render_blocks(job);
        }
        selector_.keep(std::move(made));
        TensorXf image = finish(sensor->film(), develop, evaluate);
        if (!m_stop) {
            Log(Info, "Rendering finished. (took %s)",
                util::time_string(static_cast<float>(m_render_timer.value()), true));
        }
        return image;
    }

    /// Only for render(): throws elsewhere, as from within another integrator, since nobody would
    /// redraw the ranges there.
    std::pair<Spectrum, Mask> sample(const Scene*, Sampler* sampler, const RayDifferential3f& ray,
                                     const Medium*, Float*, Mask active) const override {
        DRJIT_MARK_USED(active);
        const auto* task = RenderTask<Float, Spectrum>::current();
        if (!task || task->setup.integrator != this) {
            Throw("lightcull_path must be the scene's own integrator, not one within another");
        }
        if constexpr (dr::is_jit_v<Float>) {
            return trace_wavefront(task->setup, sampler, ray, task->part.pass());
        } else {
            return trace_path(task->setup, sampler, ray, task->part);
        }
    }

    TensorXf render_forward(Scene*, void*, Sensor*, UInt32, std::uint32_t) override {
        refuse_derivatives();
    }
    void render_backward(Scene*, void*, const TensorXf&, Sensor*, UInt32, std::uint32_t) override {
        refuse_derivatives();
    }

    std::string to_string() const override {
        return tfm::format(
            "LightcullPath[\n  max_depth = %u,\n  rr_depth = %u,\n"
            "  light_sampler = %s\n]",
            m_max_depth, m_rr_depth, description_);
    }

    MI_DECLARE_CLASS(LightcullPath)

  private:
    /// A render under way.
    struct Job {
        PathSetup<Float, Spectrum> setup;
        ::lightcull::LightSampler& selector;
        Sensor* sensor;
        ScalarVector2u size;  ///< pixels that get samples, those of the border included
        std::size_t channels;
        std::uint32_t seed, spp;
    };

    [[noreturn]] static void refuse_derivatives() {
        Throw("lightcull_path has no derivatives; for gradients, render with Mitsuba's prb");
    }

    static ScalarVector2u sampled_size(const Film* film) {
        ScalarVector2u size = film->crop_size();
        if (film->sample_border()) size += 2 * film->rfilter()->border_size();
        return size;
    }

    /// The one of the last render, where it would be made from the same.
    std::unique_ptr<MadeSampler> make_selector(const Scene* scene, const Sensor* sensor,
                                               const SceneLights<Float, Spectrum>& lights,
                                               const ScalarVector2u& size) {
        SamplerInput input{description_, lights.lights(),
                           typical_points<Float, Spectrum>(scene, sensor), size.x() * size.y()};
        std::unique_ptr<MadeSampler> made = selector_.take();
        if (made && made->is_of(input)) {
            Log(Info, "The light sampler of the last render serves again");
            return made;
        }
        in_arena([&] { made = std::make_unique<MadeSampler>(std::move(input)); });
        return made;
    }

    void render_blocks(const Job& job) {
        if constexpr (!dr::is_jit_v<Float>) {
            using Passes = BlockPasses<Float, Spectrum>;
            const std::uint32_t range_sets = job.selector.set_count();
            Passes passes(job.sensor, job.size, job.channels, m_block_size, job.seed, job.spp,
                          range_sets);
            const float differential_scale = dr::rsqrt(static_cast<float>(job.spp));
            for (std::uint32_t pass = 0; pass < passes.count() && !should_stop(); ++pass) {
                in_arena([&] { job.selector.begin_pass(number_of_pass(job.seed, pass)); });
                passes.run(
                    pass,
                    [&](const typename Passes::Pixel& pixel, Sampler* sampler, ImageBlock* block,
                        Float* channels) {
                        const PathSets sets =
                            sets_of_sample(pixel.x, pixel.y, pixel.sample, range_sets);
                        const RenderTask<Float, Spectrum> task(job.setup, sets);
                        render_sample(job.setup.scene, job.sensor, sampler, block, channels,
                                      pixel.corner, differential_scale);
                    },
                    [&] { return should_stop(); });
            }
        }
    }

    void render_wavefronts(const Job& job) {
        if constexpr (dr::is_jit_v<Float>) {
            const dr::suspend_grad<Float> no_derivatives;
            const LightTables<Float, Spectrum> tables(job.setup.scene, *job.setup.lights);
            PathSetup<Float, Spectrum> setup = job.setup;
            setup.tables = &tables;
            WavefrontPasses<Float, Spectrum> passes(job.sensor, job.size, job.seed, job.spp,
                                                    job.selector.set_count(), memory_);
            const RenderTask<Float, Spectrum> task(setup, passes);
            const float differential_scale = dr::rsqrt(static_cast<float>(job.spp));
            const std::unique_ptr<Float[]> channels(new Float[job.channels]);
            Progress progress(passes.count());
            for (std::uint32_t pass = 0; pass < passes.count() && !should_stop(); ++pass) {
                in_arena([&] {
                    job.selector.begin_pass(number_of_pass(job.seed, pass));
                    render_sample(setup.scene, job.sensor, passes.sampler(), passes.block(),
                                  channels.get(), passes.corners(), differential_scale);
                });
                passes.advance();
                progress.step();
            }
            passes.finish();
        } else {
            DRJIT_MARK_USED(job);
        }
    }

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
    Spare<MadeSampler> selector_;
    LaneMemory memory_;  // of the render whose turn it is
};

namespace {

template <typename Float, typename Spectrum>
void register_variant(std::string_view name, PluginRegisterFn register_plugin) {
    using Plugin = LightcullPath<Float, Spectrum>;
    register_plugin(
        name, Plugin::Variant, ObjectType::Integrator,
        [](void*, const Properties& properties) -> ref<Object> { return new Plugin(properties); });
}

}  // namespace
}  // namespace mitsuba::culling

extern "C" MI_EXPORT void init_plugin(std::string_view name,
                                      mitsuba::PluginRegisterFn register_plugin) {
    using namespace mitsuba::culling;
#define REGISTER(Float, Spectrum) register_variant<Float, Spectrum>(name, register_plugin);
    LIGHTCULL_VARIANTS(REGISTER)
#undef REGISTER
    register_refusals(name, register_plugin);
}
