#include <lightcull/samplers.h>

#include <vector>

#include "base/alias_table.h"
#include "base/refine.h"
#include "lights/light/light_record.h"

namespace lightcull {
namespace {

AliasTable make_intensity_table(const LightTable& table) {
    if (table.lit.empty()) return {};
    std::vector<double> weights;
    weights.reserve(table.records.size());
    for (const LightRecord& light : table.records) {
        weights.push_back(static_cast<double>(light.intensity));
    }
    return AliasTable(weights);
}

class PowerSampler final : public LightSampler {
  public:
    explicit PowerSampler(const LightTable& table) : table_(make_intensity_table(table)) {}

    using LightSampler::select;

    void begin_pass(std::uint64_t) override {}

    Selection select(const ShadingPoint& point, float u) const noexcept override {
        if (table_.empty()) return {};
        const std::uint32_t light = table_.sample(refine(u, point));
        return {light, table_.prob(light), {}};
    }

    float prob(const ShadingPoint&, const Receipt&, std::uint32_t light) const noexcept override {
        return table_.empty() ? 0.0f : table_.prob(light);
    }

    SelectionCounts count(const ShadingPoint&) const noexcept override {
        return {0, 0, table_.size()};
    }

    std::size_t memory_size() const noexcept override { return table_.memory_size(); }

  private:
    AliasTable table_;
};

}  // namespace

std::unique_ptr<LightSampler> make_power_sampler(Span<const Light> lights) {
    return std::make_unique<PowerSampler>(make_light_table(lights));
}

}  // namespace lightcull
