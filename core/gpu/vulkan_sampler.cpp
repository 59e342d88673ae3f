#include <lightcull/gpu/vulkan_sampler.h>

#include <lightcull/error.h>
#include <lightcull/sampler_info.h>
#include <lightcull/samplers.h>

#include <exception>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "base/parallel_blocks.h"
#include "gpu/device_sampler.h"
#include "lights/glossy/directed_culled_sampler.h"

namespace lightcull {
namespace {

class VulkanLightSampler : public LightSampler, public SamplerInfo {
  public:
    /// frame, tree: those of `cpu`.
    VulkanLightSampler(std::unique_ptr<LightSampler> cpu, const Frame& frame, const RangeTree& tree,
                       const Chooser& chooser, const VulkanOptions& options)
        : cpu_(std::move(cpu)), tree_(tree) {
        // Without any light there is nothing to choose from, nor to upload.
        if (!tree.tree().empty()) device_ = DeviceSampler::make(frame, tree, chooser, options);
    }

    void begin_pass(std::uint64_t pass) override {
        cpu_->begin_pass(pass);
        attempt([&] { device_->refit(tree_.ranges()); });
        if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
    }

    std::unique_ptr<const LightSelector> pass(std::uint64_t number) const override {
        return cpu_->pass(number);
    }

    LightUpdate update(Span<const Light>, float) override {
        throw Error("Vulkan: a device keeps its lights, so that changed ones want another sampler");
    }

    Selection select(const ShadingPoint& point, float u) const noexcept override {
        return cpu_->select(point, u);
    }

    void select(Span<const ShadingPoint> points, Span<const float> u,
                Span<Selection> selections) const override {
        if (!select_on_device(points, u, selections)) {
            cpu_->select(points, u, selections);
            return;
        }
        constexpr std::size_t kBlock = 4096;
        for_each_block(points.size(), kBlock, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) finish(points[i], selections[i]);
        });
    }

    float prob(const ShadingPoint& point, const Receipt& receipt,
               std::uint32_t light) const noexcept override {
        return cpu_->prob(point, receipt, light);
    }
    bool needs_receipt() const noexcept override { return cpu_->needs_receipt(); }
    std::uint32_t set_count() const noexcept override { return cpu_->set_count(); }
    SelectionCounts count(const ShadingPoint& point) const noexcept override {
        return sampler_info(*cpu_)->count(point);
    }
    std::size_t memory_size() const noexcept override {
        const std::lock_guard lock(mutex_);
        return sampler_info(*cpu_)->memory_size() + (device_ ? device_->memory_size() : 0);
    }

  protected:
    const LightSampler& cpu() const noexcept { return *cpu_; }

  private:
    /// False if the device did not do it.
    bool select_on_device(Span<const ShadingPoint> points, Span<const float> u,
                          Span<Selection> selections) const noexcept {
        const std::lock_guard lock(mutex_);
        return attempt([&] { device_->select(points, u, selections); });
    }

    /// Runs an action on the device. False if there is no device, or none any more.
    template <typename Action>
    bool attempt(const Action& action) const noexcept {
        if (!device_) return false;
        try {
            action();
        } catch (...) {
            failure_ = std::current_exception();
            device_.reset();
            return false;
        }
        return true;
    }

    /// Where `culled` accepted one group at most, few points as a rule, prob() is that of the
    /// selection.
    virtual void finish(const ShadingPoint& point, Selection& selection) const noexcept {
        if (!(selection.receipt.weight_sum > 0.0f) && selection.prob != 0.0f) {
            selection.prob = cpu_->prob(point, selection.receipt, selection.light);
        }
        selection.mis_prob = selection.prob;
    }

    std::unique_ptr<LightSampler> cpu_;
    const RangeTree& tree_;
    mutable std::mutex mutex_;              ///< guards the members below
    mutable DeviceSampler::Handle device_;  ///< none without lights, nor after a failure
    mutable std::exception_ptr failure_;    ///< failure that is still to be told
};

/// The sampler `paper`, which has a list here, so that its prob() is a stand-in.
class VulkanPaperSampler final : public VulkanLightSampler, public VertexCulling {
  public:
    using VulkanLightSampler::VulkanLightSampler;

    float vertex_prob(const ShadingPoint& point, const Receipt& receipt, std::uint32_t light,
                      const float3& vertex) const noexcept override {
        return vertex_culling(cpu())->vertex_prob(point, receipt, light, vertex);
    }

  private:
    void finish(const ShadingPoint& point, Selection& selection) const noexcept override {
        if (selection.prob == 0.0f) return;
        selection.mis_prob = cpu().prob(point, selection.receipt, selection.light);
    }
};

[[noreturn]] void fail_for_glossy() {
    throw Error("Vulkan: there are glossy points among the lights, which no device chooses");
}

void check_no_glossy(const std::vector<LightRecord>& records) {
    for (const LightRecord& light : records) {
        if (light.is_glossy()) fail_for_glossy();
    }
}

}  // namespace

std::unique_ptr<LightSampler> make_vulkan_sampler(std::unique_ptr<LightSampler> sampler,
                                                  const VulkanOptions& options) {
    if (const auto* culled = dynamic_cast<const CulledSamplerBase*>(sampler.get())) {
        const CulledScene scene = culled->scene();
        return std::make_unique<VulkanLightSampler>(std::move(sampler), scene.frame, scene.tree,
                                                    chooser_of(scene), options);
    }
    const auto* paper = dynamic_cast<const PaperSamplerBase*>(sampler.get());
    if (paper != nullptr && paper->scene().list_size > 0) {
        const PaperScene scene = paper->scene();
        check_no_glossy(scene.tree.records());
        return std::make_unique<VulkanPaperSampler>(std::move(sampler), scene.tree.frame(),
                                                    scene.tree.tree(), chooser_of(scene), options);
    }
    if (dynamic_cast<const DirectedCulledSamplerBase*>(sampler.get()) != nullptr) fail_for_glossy();
    throw Error("Vulkan: of the samplers, only culled and paper (with a list) run on a device");
}

}  // namespace lightcull
