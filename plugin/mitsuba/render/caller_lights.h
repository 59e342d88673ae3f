#pragma once

#include <mitsuba/render/sampler.h>
#include <mitsuba/render/scene.h>

#include <memory>
#include <mutex>
#include <shared_mutex>
#include <thread>
#include <unordered_map>

#include "sampler/reusable_sampler.h"
#include "sampler/sampler_arena.h"
#include "sampler/sampler_description.h"
#include "scene/scene_lights.h"
#include "scene/surface_receiver.h"
#include "volume/scene_media.h"

namespace mitsuba::culling {

/// The lights of the scene, in scalar variants, for paths that are asked for one by one, from any
/// thread. Where another integrator asks, nobody says when lights change, so that a thread looks at
/// them again whenever it comes with another sampler: an integrator takes one for each thread at
/// the start of a render, and for some blocks.
template <typename Float, typename Spectrum>
class CallerLights {
  public:
    MI_IMPORT_TYPES(Scene, Sampler)

    /// What paths need to know.
    struct Known {
        explicit Known(const Scene* scene)
            : scene(scene), lights(scene), has_lobes(has_glossy_surfaces(scene)), media(scene) {}

        const Scene* scene;
        SceneLights<Float, Spectrum> lights;
        bool has_lobes;
        SceneMedia media;
        std::shared_ptr<const ReusableSampler> light_sampler;
    };

    /// What the calling thread knows; it stays for as long as the thread does not ask again.
    const Known& of(const Scene* scene, Sampler* sampler) {
        {
            const std::shared_lock lock(mutex_);
            const auto found = askers_.find(std::this_thread::get_id());
            if (found != askers_.end() && found->second.sampler.get() == sampler &&
                found->second.known->scene == scene) {
                return *found->second.known;
            }
        }
        auto known = std::make_unique<Known>(scene);
        const std::unique_lock lock(mutex_);
        known->light_sampler = light_sampler(known->lights);
        Asker& asker = askers_[std::this_thread::get_id()];
        asker = {sampler, std::move(known)};
        return *asker.known;
    }

    /// What paths need to know, for a render that announces itself: for as long as anyone keeps
    /// what this returns, held() gives it to all threads, and the lights stay as they are now.
    std::shared_ptr<const Known> hold(const Scene* scene) {
        if (auto known = held(scene)) return known;
        auto known = std::make_shared<Known>(scene);
        const std::unique_lock lock(mutex_);
        known->light_sampler = light_sampler(known->lights);
        held_[scene] = known;
        return known;
    }

    /// What is held of a scene; null: nothing.
    std::shared_ptr<const Known> held(const Scene* scene) {
        const std::shared_lock lock(mutex_);
        const auto found = held_.find(scene);
        return found == held_.end() ? nullptr : found->second.lock();
    }

  private:
    /// A thread that asks.
    struct Asker {
        ref<Sampler> sampler;  ///< kept, so that no other one gets its address
        std::unique_ptr<const Known> known;
    };

    /// The light sampler of the last call if the lights are the same, else a new one.
    std::shared_ptr<const ReusableSampler> light_sampler(
        const SceneLights<Float, Spectrum>& lights) {
        SamplerInput input{kMeans, lights.lights(), {}, 0};
        if (!light_sampler_ || !light_sampler_->is_made_from(input)) {
            in_sampler_arena([&] {
                light_sampler_ = std::make_shared<ReusableSampler>(std::move(input));
                light_sampler_->sampler().begin_pass(0);
            });
        }
        return light_sampler_;
    }

    std::shared_mutex mutex_;
    std::unordered_map<std::thread::id, Asker> askers_;
    std::unordered_map<const Scene*, std::weak_ptr<const Known>> held_;
    std::shared_ptr<const ReusableSampler> light_sampler_;
};

}  // namespace mitsuba::culling
