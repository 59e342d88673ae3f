#include <lightcull/checked_sampler.h>
#include <lightcull/error.h>
#include <lightcull/samplers.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>
#include <vector>

#include "base/float3_math.h"

namespace lightcull {
namespace {

bool is_unit(float3 v) noexcept {
    constexpr float kRounding = 1e-3f;
    return std::abs(dot(v, v) - 1.0f) < kRounding;
}

bool is_zero(float3 v) noexcept {
    return v.x == 0.0f && v.y == 0.0f && v.z == 0.0f;
}

/// The fault of a point, or nullptr.
const char* fault_of(const ShadingPoint& point, std::uint32_t set_count) noexcept {
    if (!is_finite(point.position)) return "position is not finite";
    if (!is_finite(point.normal)) return "normal is not finite";
    if (!is_unit(point.normal) && !is_zero(point.normal)) {
        return "the length of normal is neither 1 nor 0";
    }
    if (point.set >= set_count) return "set is not below set_count()";
    if (!(point.diffuse >= 0.0f && std::isfinite(point.diffuse))) {
        return "diffuse is not finite and 0 or more";
    }
    const GlossyLobe& lobe = point.lobe;
    if (!(lobe.peak >= 0.0f && std::isfinite(lobe.peak))) {
        return "lobe.peak is not finite and 0 or more";
    }
    if (lobe.peak == 0.0f) return nullptr;
    if (!is_unit(lobe.axis)) return "the length of lobe.axis is not 1";
    if (!(lobe.alpha > 0.0f && lobe.alpha <= 1.0f)) return "lobe.alpha is not in (0, 1]";
    return nullptr;
}

[[noreturn]] void abort_for(const std::string& fault) {
    std::fprintf(stderr, "lightcull: %s\n", fault.c_str());
    std::abort();
}

/// The checks that checked samplers and their passes have in common.
struct Checks {
    std::size_t light_count;
    FaultHandler on_fault;

    /// True if a call may go on. `what` and `fault`: null if nothing is wrong.
    bool passes(const char* call, const char* fault, std::size_t index) const {
        if (fault == nullptr) return true;
        on_fault(std::string(call) + ": point " + std::to_string(index) + ": " + fault);
        return false;
    }

    bool passes(const char* call, const ShadingPoint& point, float u, std::uint32_t set_count,
                std::size_t index) const {
        const char* fault = fault_of(point, set_count);
        if (fault == nullptr && !(u >= 0.0f && u < 1.0f)) fault = "u is not in [0, 1)";
        return passes(call, fault, index);
    }

    Selection select(const LightSelector& inner, const ShadingPoint& point, float u) const {
        if (!passes("select()", point, u, inner.set_count(), 0)) return {};
        return inner.select(point, u);
    }

    void select(const LightSelector& inner, Span<const ShadingPoint> points, Span<const float> u,
                Span<Selection> selections) const {
        if (u.size() != points.size() || selections.size() != points.size()) {
            on_fault("select(): there are " + std::to_string(points.size()) + " points, " +
                     std::to_string(u.size()) + " u and room for " +
                     std::to_string(selections.size()) + " selections");
            for (Selection& selection : selections) selection = {};
            return;
        }
        bool all = true;
        for (std::size_t i = 0; i < points.size(); ++i) {
            all = passes("select()", points[i], u[i], inner.set_count(), i) && all;
        }
        if (all) return inner.select(points, u, selections);
        for (Selection& selection : selections) selection = {};
    }

    float prob(const LightSelector& inner, const ShadingPoint& point, const Receipt& receipt,
               std::uint32_t light) const {
        const char* fault = fault_of(point, inner.set_count());
        if (fault == nullptr && light >= light_count) fault = "there is no light of that index";
        if (fault == nullptr && !inner.knows(receipt)) {
            fault = "the receipt is of another sampler";
        }
        if (!passes("prob()", fault, 0)) return 0.0f;
        return inner.prob(point, receipt, light);
    }
};

class CheckedPass final : public LightSelector {
  public:
    CheckedPass(std::unique_ptr<const LightSelector> inner, std::shared_ptr<const Checks> checks)
        : inner_(std::move(inner)), checks_(std::move(checks)) {}

    Selection select(const ShadingPoint& point, float u) const noexcept override {
        return checks_->select(*inner_, point, u);
    }
    void select(Span<const ShadingPoint> points, Span<const float> u,
                Span<Selection> selections) const override {
        checks_->select(*inner_, points, u, selections);
    }
    float prob(const ShadingPoint& point, const Receipt& receipt,
               std::uint32_t light) const noexcept override {
        return checks_->prob(*inner_, point, receipt, light);
    }
    bool needs_receipt() const noexcept override { return inner_->needs_receipt(); }
    void report(Span<const LightOutcome> outcomes) const noexcept override {
        inner_->report(outcomes);
    }
    bool wants_reports() const noexcept override { return inner_->wants_reports(); }
    bool knows(const Receipt& receipt) const noexcept override { return inner_->knows(receipt); }
    std::uint32_t set_count() const noexcept override { return inner_->set_count(); }

  private:
    std::unique_ptr<const LightSelector> inner_;
    std::shared_ptr<const Checks> checks_;
};

class CheckedSampler final : public LightSampler {
  public:
    CheckedSampler(std::unique_ptr<LightSampler> inner, std::shared_ptr<const Checks> checks)
        : inner_(std::move(inner)), checks_(std::move(checks)) {}

    void begin_pass(std::uint64_t pass) override {
        inner_->begin_pass(pass);
        has_pass_ = true;
    }
    std::unique_ptr<const LightSelector> pass(std::uint64_t number) const override {
        return std::make_unique<CheckedPass>(inner_->pass(number), checks_);
    }

    LightUpdate update(Span<const Light> lights, float max_growth) override {
        const LightUpdate result = inner_->update(lights, max_growth);
        has_pass_ = false;
        return result;
    }

    Selection select(const ShadingPoint& point, float u) const noexcept override {
        return has_begun("select()") ? checks_->select(*inner_, point, u) : Selection{};
    }
    void select(Span<const ShadingPoint> points, Span<const float> u,
                Span<Selection> selections) const override {
        if (has_begun("select()")) return checks_->select(*inner_, points, u, selections);
        for (Selection& selection : selections) selection = {};
    }
    float prob(const ShadingPoint& point, const Receipt& receipt,
               std::uint32_t light) const noexcept override {
        return has_begun("prob()") ? checks_->prob(*inner_, point, receipt, light) : 0.0f;
    }
    bool needs_receipt() const noexcept override { return inner_->needs_receipt(); }
    void report(Span<const LightOutcome> outcomes) const noexcept override {
        inner_->report(outcomes);
    }
    void drop_reports() noexcept override { inner_->drop_reports(); }
    std::vector<std::uint8_t> learned() const override { return inner_->learned(); }
    void restore_learned(Span<const std::uint8_t> bytes) override {
        inner_->restore_learned(bytes);
        has_pass_ = false;
    }
    bool wants_reports() const noexcept override { return inner_->wants_reports(); }
    bool knows(const Receipt& receipt) const noexcept override { return inner_->knows(receipt); }
    std::uint32_t set_count() const noexcept override { return inner_->set_count(); }

  private:
    bool has_begun(const char* call) const {
        if (has_pass_) return true;
        checks_->on_fault(std::string(call) + ": begin_pass() must come first");
        return false;
    }

    std::unique_ptr<LightSampler> inner_;
    std::shared_ptr<const Checks> checks_;
    bool has_pass_ = false;
};

}  // namespace

std::unique_ptr<LightSampler> make_checked_sampler(std::unique_ptr<LightSampler> sampler,
                                                   std::size_t light_count, FaultHandler on_fault) {
    if (sampler == nullptr) throw Error("checked sampler: there is no sampler");
    if (vertex_culling(*sampler) != nullptr) {
        throw Error("checked sampler: paper with its test at the vertex is not for hosts to check");
    }
    if (!on_fault) on_fault = abort_for;
    auto checks = std::make_shared<const Checks>(Checks{light_count, std::move(on_fault)});
    return std::make_unique<CheckedSampler>(std::move(sampler), std::move(checks));
}

}  // namespace lightcull
