#include <algorithm>
#include <vector>

#include "base/memory_size.h"
#include "base/refine.h"
#include "lights/light/light_record.h"
#include "lights/samplers/make_samplers.h"
#include "lights/samplers/passless_sampler.h"

namespace lightcull {
namespace {

struct LitLights {
    std::vector<std::uint32_t> lit;
    std::vector<bool> is_lit;

    explicit LitLights(LightTable table) : lit(std::move(table.lit)), is_lit(table.records.size()) {
        for (const std::uint32_t i : lit) is_lit[i] = true;
    }
};

class UniformSampler final : public PasslessSampler<UniformSampler> {
  public:
    explicit UniformSampler(LightTable table)
        : lights_(std::make_shared<const LitLights>(std::move(table))) {}

    using LightSampler::select;

    Selection select(const ShadingPoint& point, float u) const noexcept override {
        const std::vector<std::uint32_t>& lit = lights_->lit;
        if (lit.empty()) return {};
        const double place = refine(u, point) * static_cast<double>(lit.size());
        const std::size_t i = std::min(static_cast<std::size_t>(place), lit.size() - 1);
        const float prob = 1.0f / static_cast<float>(lit.size());
        return {lit[i], prob, prob, {}};
    }

    float prob(const ShadingPoint&, const Receipt&, std::uint32_t light) const noexcept override {
        return lights_->is_lit[light] ? 1.0f / static_cast<float>(lights_->lit.size()) : 0.0f;
    }
    bool needs_receipt() const noexcept override { return false; }

    LightUpdate update(Span<const Light> lights, float) override {
        lights_ = std::make_shared<const LitLights>(
            make_updated_light_table(lights, lights_->is_lit.size()));
        return {true, 1.0f};
    }

    SelectionCounts count(const ShadingPoint&) const noexcept override {
        return {0, 0, static_cast<std::uint32_t>(lights_->lit.size())};
    }

    std::size_t memory_size() const noexcept override {
        return size_of(lights_->lit) + lights_->is_lit.size() / 8;
    }

  private:
    std::shared_ptr<const LitLights> lights_;
};

}  // namespace

std::unique_ptr<LightSampler> make_uniform_sampler(Span<const Light> lights) {
    return std::make_unique<UniformSampler>(make_light_table(lights));
}

}  // namespace lightcull
