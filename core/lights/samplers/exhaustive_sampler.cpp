#include "base/memory_size.h"
#include "base/reservoir.h"
#include "lights/light/importance.h"
#include "lights/light/light_record.h"
#include "lights/samplers/make_samplers.h"
#include "lights/samplers/passless_sampler.h"

namespace lightcull {
namespace {

class ExhaustiveSampler final : public PasslessSampler<ExhaustiveSampler> {
  public:
    explicit ExhaustiveSampler(LightTable table)
        : table_(std::make_shared<const LightTable>(std::move(table))) {}

    using LightSampler::select;

    Selection select(const ShadingPoint& point, float u) const noexcept override {
        const Receiver receiver(table_->frame, point);
        Reservoir reservoir(u);
        for (const std::uint32_t i : table_->lit) {
            const float g = importance_at(receiver, i);
            if (g > 0.0f) reservoir.add(i, g, g);
        }
        if (!reservoir.chosen()) return {};
        const float prob = reservoir.prob();
        return {reservoir.light(), prob, prob, {reservoir.weight_sum(), 0}};
    }

    float prob(const ShadingPoint& point, const Receipt& receipt,
               std::uint32_t light) const noexcept override {
        const Receiver receiver(table_->frame, point);
        const float g = importance_at(receiver, light);
        return g > 0.0f ? g / receipt.weight_sum : 0.0f;
    }

    LightUpdate update(Span<const Light> lights, float) override {
        table_ = std::make_shared<const LightTable>(
            make_updated_light_table(lights, table_->records.size()));
        return {true, 1.0f};
    }

    SelectionCounts count(const ShadingPoint& point) const noexcept override {
        const Receiver receiver(table_->frame, point);
        SelectionCounts counts;
        counts.lights_tested = static_cast<std::uint32_t>(table_->lit.size());
        for (const std::uint32_t i : table_->lit) {
            if (importance_at(receiver, i) > 0.0f) ++counts.accepted;
        }
        return counts;
    }

    std::size_t memory_size() const noexcept override {
        return size_of(table_->records) + size_of(table_->lit);
    }

  private:
    float importance_at(const Receiver& receiver, std::uint32_t i) const noexcept {
        const LightRecord& light = table_->records[i];
        return importance(light, approach(receiver.position, light.center), receiver);
    }

    std::shared_ptr<const LightTable> table_;
};

}  // namespace

std::unique_ptr<LightSampler> make_exhaustive_sampler(Span<const Light> lights) {
    return std::make_unique<ExhaustiveSampler>(make_light_table(lights));
}

}  // namespace lightcull
