#include <lightcull/samplers.h>

#include <algorithm>
#include <vector>

#include "base/memory_size.h"
#include "base/refine.h"
#include "lights/light/light_record.h"

namespace lightcull {
namespace {

class UniformSampler final : public LightSampler {
  public:
    explicit UniformSampler(const LightTable& table)
        : lit_(table.lit), is_lit_(table.records.size()) {
        for (const std::uint32_t i : lit_) is_lit_[i] = true;
    }

    using LightSampler::select;

    void begin_pass(std::uint64_t) override {}

    Selection select(const ShadingPoint& point, float u) const noexcept override {
        if (lit_.empty()) return {};
        const double place = refine(u, point) * static_cast<double>(lit_.size());
        const std::size_t i = std::min(static_cast<std::size_t>(place), lit_.size() - 1);
        return {lit_[i], 1.0f / static_cast<float>(lit_.size()), {}};
    }

    float prob(const ShadingPoint&, const Receipt&, std::uint32_t light) const noexcept override {
        return is_lit_[light] ? 1.0f / static_cast<float>(lit_.size()) : 0.0f;
    }

    SelectionCounts count(const ShadingPoint&) const noexcept override {
        return {0, 0, static_cast<std::uint32_t>(lit_.size())};
    }

    std::size_t memory_size() const noexcept override { return size_of(lit_) + is_lit_.size() / 8; }

  private:
    std::vector<std::uint32_t> lit_;
    std::vector<bool> is_lit_;
};

}  // namespace

std::unique_ptr<LightSampler> make_uniform_sampler(Span<const Light> lights) {
    return std::make_unique<UniformSampler>(make_light_table(lights));
}

}  // namespace lightcull
