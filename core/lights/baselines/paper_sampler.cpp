#include <lightcull/sampler_info.h>

#include <algorithm>
#include <cmath>

#include "base/reservoir.h"
#include "lights/baselines/make_baselines.h"
#include "lights/baselines/paper_scene.h"
#include "lights/calibration/range_calibration.h"

namespace lightcull {
namespace {

/// lightList of [TH16] Alg. 2, kept to k entries by the reservoir sampling of Alg. 3.
class LightList {
  public:
    LightList(std::uint32_t capacity, std::uint64_t key) noexcept
        : capacity_(capacity), random_(key) {}

    void add(const Accepted& accepted) noexcept {
        if (found_ < capacity_) {
            list_[found_++] = accepted;
            return;
        }
        ++found_;
        const float place = random_.next() * static_cast<float>(found_);
        if (place < static_cast<float>(capacity_)) {
            list_[static_cast<std::uint32_t>(place)] = accepted;
        }
    }
    std::uint32_t size() const noexcept { return std::min(found_, capacity_); }
    const Accepted& operator[](std::uint32_t i) const noexcept { return list_[i]; }

    /// The first light at which the sums of weights in cdf, as many as there are lights, rise above
    /// the u-th part of the last. u is in [0, 1).
    const Accepted& sample(const float* cdf, float u) const noexcept {
        const float* const last = cdf + size() - 1;
        return list_[std::upper_bound(cdf, last, u * *last) - cdf];
    }
    /// The probability min(k / m, 1) of Eq. 10.
    float keep_prob() const noexcept {
        return found_ <= capacity_ ? 1.0f
                                   : static_cast<float>(capacity_) / static_cast<float>(found_);
    }

  private:
    std::uint32_t capacity_, found_ = 0;
    RandomStream random_;
    Accepted list_[PaperScene::kMaxListSize];
};

/// [TH16] Alg. 2 with one shadow ray (section 5.3.2), and the departures from it one by one. For
/// Eq. 9 it takes importance(), as all samplers do: the corners of a triangle are the caller's.
class PaperSampler final : public PaperSamplerBase, public SamplerInfo {
  public:
    PaperSampler(const LightTable& table, float reach, const PaperOptions& options)
        : tree_(table, RandomRanges(reach, options.set_count)),
          range_at_vertex_(options.range_at_vertex),
          weight_by_g_(options.weight_by_g),
          list_size_(options.list_size),
          intensity_sum_(0.0f) {
        double sum = 0.0;
        for (const std::uint32_t i : table.lit) {
            sum += static_cast<double>(intensity_nearby(table.records[i]));
        }
        intensity_sum_ = static_cast<float>(sum);
    }

    PaperSampler(const PaperSampler& other, std::uint64_t pass)
        : tree_(other.tree_, pass),
          range_at_vertex_(other.range_at_vertex_),
          weight_by_g_(other.weight_by_g_),
          list_size_(other.list_size_),
          intensity_sum_(other.intensity_sum_) {}

    using LightSampler::select;

    PaperScene scene() const noexcept override {
        return {tree_, range_at_vertex_, weight_by_g_, list_size_};
    }

    void begin_pass(std::uint64_t pass) override { tree_.begin_pass(pass); }

    std::unique_ptr<const LightSelector> pass(std::uint64_t number) const override {
        return std::make_unique<PaperSampler>(*this, number);
    }

    LightUpdate update(Span<const Light> lights, float) override {
        const LightTable table = make_updated_light_table(lights, tree_.light_count());
        const PaperOptions options{{}, set_count(), range_at_vertex_, weight_by_g_, list_size_};
        *this = PaperSampler(table, reach_in(table.frame, tree_.ranges().reach(), tree_.frame()),
                             options);
        return {true, 1.0f};
    }

    Selection select(const ShadingPoint& point, float u) const noexcept override {
        return list_size_ == 0 ? select_of_all(point, u) : select_of_list(point, u);
    }

    float prob(const ShadingPoint& point, const Receipt& receipt,
               std::uint32_t light) const noexcept override {
        const std::uint32_t record = tree_.to_record(light);
        if (record == CullingTree::kNoRecord) return 0.0f;
        const LightRecord& data = tree_.record(record);
        if (has_proxy()) return intensity_nearby(data) / intensity_sum_;
        const Receiver receiver(tree_.frame(), point);
        const Approach way = approach(receiver.position, data.center);
        const Accepted as_if{record, importance(data, way, receiver),
                             tree_.tree().inverse_prob(record, way)};
        if (!(as_if.importance > 0.0f)) return 0.0f;
        const bool accepted = tree_.tree().accepts(record, receipt.key, way);
        const float sum = receipt.weight_sum + (accepted ? 0.0f : weight(as_if));
        return numerator(as_if) / sum;
    }

    bool needs_receipt() const noexcept override { return !has_proxy(); }

    float vertex_prob(const ShadingPoint& point, const Receipt& receipt, std::uint32_t light,
                      const float3& vertex) const noexcept override {
        if (!range_at_vertex_) return 1.0f;
        const Frame& frame = tree_.frame();
        const RandomRanges& ranges = tree_.ranges();
        const std::uint32_t record = tree_.to_record(light);
        const LightRecord& data = tree_.record(record);
        const float intensity = data.intensity;
        // The vertex of a sun is nowhere.
        const float3 end = is_far(data) ? data.center : frame.position(vertex);
        const float distance = length(end - frame.position(point.position));
        if (distance > ranges.range(intensity, ranges.xi(record, receipt.key))) return 0.0f;
        return 1.0f / ranges.inverse_prob(intensity, distance);
    }

    std::uint32_t set_count() const noexcept override { return tree_.ranges().set_count(); }

    SelectionCounts count(const ShadingPoint& point) const noexcept override {
        return tree_.for_each_accepted(Receiver(tree_.frame(), point), point.set,
                                       [](const Accepted&) {});
    }

    std::size_t memory_size() const noexcept override { return tree_.memory_size(); }

  private:
    /// True if prob() is a stand-in, for MIS weights alone: a light's own probability is not known
    /// where a list or the vertex has decided.
    bool has_proxy() const noexcept { return range_at_vertex_ || list_size_ > 0; }

    Selection selection(std::uint32_t record, float prob, const Receipt& receipt) const noexcept {
        const float mis_prob =
            has_proxy() ? intensity_nearby(tree_.record(record)) / intensity_sum_ : prob;
        return {tree_.to_light(record), prob, mis_prob, receipt};
    }

    float weight(const Accepted& accepted) const noexcept {
        return weight_by_g_ ? accepted.importance : accepted.importance * accepted.inverse_prob;
    }
    /// The product p_i q(i) of Eq. 10 times the sum in q(i), without what the vertex decides.
    float numerator(const Accepted& accepted) const noexcept {
        return range_at_vertex_ ? weight(accepted) : weight(accepted) / accepted.inverse_prob;
    }

    Selection select_of_all(const ShadingPoint& point, float u) const noexcept {
        const Receiver receiver(tree_.frame(), point);
        Reservoir reservoir(u);
        tree_.for_each_accepted(receiver, point.set, [&](const Accepted& accepted) {
            reservoir.add(accepted.record, numerator(accepted), weight(accepted));
        });
        const Receipt receipt{reservoir.weight_sum(), point.set};
        if (!reservoir.chosen()) return {0, 0.0f, 0.0f, receipt};
        return selection(reservoir.light(), reservoir.prob(), receipt);
    }

    Selection select_of_list(const ShadingPoint& point, float u) const noexcept {
        const Receiver receiver(tree_.frame(), point);
        const float3 x = receiver.position;
        LightList list(list_size_, hash(float_bits(u), float_bits(x.x), float_bits(x.y)));
        tree_.for_each_accepted(receiver, point.set,
                                [&](const Accepted& accepted) { list.add(accepted); });
        if (list.size() == 0) return {0, 0.0f, 0.0f, {0.0f, point.set}};
        float cdf[PaperScene::kMaxListSize], sum = 0.0f;
        for (std::uint32_t i = 0; i < list.size(); ++i) cdf[i] = sum += weight(list[i]);
        const Accepted& chosen = list.sample(cdf, u);
        return selection(chosen.record, list.keep_prob() * (numerator(chosen) / sum),
                         {sum, point.set});
    }

    CullingTree tree_;
    bool range_at_vertex_, weight_by_g_;
    std::uint32_t list_size_;
    float intensity_sum_;
};

}  // namespace

std::unique_ptr<LightSampler> make_paper_sampler(const PaperOptions& options,
                                                 Span<const Light> lights,
                                                 const SamplerContext& context) {
    const LightTable table = make_light_table(lights);
    const float reach = calibrate_reach(ranged_scene(table), options.range,
                                        context.calibration_points, RangeLaw::kRandom);
    return std::make_unique<PaperSampler>(table, reach, options);
}

}  // namespace lightcull
