#include <vector>

#include "base/alias_table.h"
#include "base/refine.h"
#include "lights/light/light_record.h"
#include "lights/samplers/make_samplers.h"
#include "lights/samplers/passless_sampler.h"

namespace lightcull {
namespace {

AliasTable make_intensity_table(const LightTable& table) {
    if (table.lit.empty()) return {};
    std::vector<double> weights;
    weights.reserve(table.records.size());
    for (const LightRecord& light : table.records) {
        weights.push_back(static_cast<double>(intensity_nearby(light)));
    }
    return AliasTable(weights);
}

class PowerSampler final : public PasslessSampler<PowerSampler> {
  public:
    explicit PowerSampler(const LightTable& table)
        : table_(std::make_shared<const AliasTable>(make_intensity_table(table))),
          light_count_(table.records.size()) {}

    using LightSampler::select;

    Selection select(const ShadingPoint& point, float u) const noexcept override {
        if (table_->empty()) return {};
        const std::uint32_t light = table_->sample(refine(u, point));
        const float prob = table_->prob(light);
        return {light, prob, prob, {}};
    }

    float prob(const ShadingPoint&, const Receipt&, std::uint32_t light) const noexcept override {
        return table_->empty() ? 0.0f : table_->prob(light);
    }
    bool needs_receipt() const noexcept override { return false; }

    LightUpdate update(Span<const Light> lights, float) override {
        *this = PowerSampler(make_updated_light_table(lights, light_count_));
        return {true, 1.0f};
    }

    SelectionCounts count(const ShadingPoint&) const noexcept override {
        return {0, 0, table_->size()};
    }

    std::size_t memory_size() const noexcept override { return table_->memory_size(); }

  private:
    std::shared_ptr<const AliasTable> table_;
    std::size_t light_count_;
};

}  // namespace

std::unique_ptr<LightSampler> make_power_sampler(Span<const Light> lights) {
    return std::make_unique<PowerSampler>(make_light_table(lights));
}

}  // namespace lightcull
