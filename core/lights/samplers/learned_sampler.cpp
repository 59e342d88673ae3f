#include <lightcull/error.h>
#include <lightcull/sampler_info.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <iterator>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/byte_stream.h"
#include "base/parallel_blocks.h"
#include "base/radix_sort.h"
#include "base/refine.h"
#include "lights/bvh/light_bvh_kernels.h"
#include "lights/groups/narrow_cones.h"
#include "lights/learning/cut_kernels.h"
#include "lights/learning/learned_cells.h"
#include "lights/samplers/culled_scene.h"
#include "lights/samplers/make_samplers.h"

namespace lightcull {
namespace {

/// A pass of `learned`. Where a cell has been made, the clusters of its cut are weighed at the
/// point, narrower ones where a lobe asks for them, and a light is found down the light BVH below
/// the one that is chosen: the probability is exact, the same in every pass in which the cell is as
/// it is, and above 0 wherever light may come from. Elsewhere the cut that is made for all points
/// serves, if there is one, or `culled` chooses. Bit 31 of a receipt's key tells a cell from a set.
class LearnedPass final : public LightSelector, public SamplerInfo {
  public:
    /// everywhere: the cut of `lights` for all points that are in no cell, or null.
    LearnedPass(std::shared_ptr<const LightSelector> fallback,
                std::shared_ptr<const LearnedLights> lights, std::shared_ptr<LearnedCells> cells,
                const ClusterCut* everywhere)
        : fallback_(std::move(fallback)),
          lights_(std::move(lights)),
          cells_(std::move(cells)),
          everywhere_(everywhere) {}

    Selection select(const ShadingPoint& point, float u) const noexcept override {
        const std::uint32_t cell = find(point);
        if (!has_cut(cell)) return fallback_->select(point, u);
        const Receiver x = to_local(point);
        if (by_light(cut_of(cell), x)) {
            LightFactors factors;
            factors.set(*lights_->rows, lights_->leaves, cut_of(cell));
            return select_by_light(cell, factors, x, refine(u, point));
        }
        CutWeights weights;
        weigh(cell, x, weights);
        LightBvhDescent descent;
        descent.receiver = x;
        choose_cluster(cell, weights, refine(u, point), descent);
        light_bvh_kernels<MeansNode>().descend(lights_->bvh(), {&descent, 1});
        return result(descent, {weights.total(), key_of(cell)});
    }

    void select(Span<const ShadingPoint> points, Span<const float> u,
                Span<Selection> selections) const override try {
        if (!has_cut(0)) return fallback_->select(points, u, selections);
        std::vector<std::uint64_t> keys(points.size()), scratch(points.size());
        const auto elsewhere = cells_->size();
        for_each_block(points.size(), kBlock, [&](std::size_t begin, std::size_t end) {
            std::uint32_t hint = LearnedCells::kNone;
            for (std::size_t i = begin; i < end; ++i) {
                const std::uint32_t cell = cells_->find(lights_->frame.position(points[i].position),
                                                        points[i].normal, hint);
                keys[i] = (std::uint64_t{std::min(cell, elsewhere)} << 32) | i;
            }
        });
        select_elsewhere(keys, points, u, selections);
        // The points of a cell come together, so that its cut is read from memory once.
        for_each_block(points.size(), kBlock, [&](std::size_t begin, std::size_t end) {
            std::uint64_t* const sorted =
                sort_keys<2>(keys.data() + begin, scratch.data() + begin, end - begin);
            const std::size_t others =
                select_by_light({sorted, end - begin}, points, u, selections);
            select_in_cells({sorted, others}, points, u, selections);
        });
    } catch (const std::bad_alloc&) {
        throw Error("select(): no memory for the cells of " + std::to_string(points.size()) +
                    " points");
    }

    float prob(const ShadingPoint& point, const Receipt& receipt,
               std::uint32_t light) const noexcept override {
        if (!is_cell(receipt)) return fallback_->prob(point, receipt, light);
        const LightBvhSlot slot = lights_->bvh().slots[light];
        if (slot == LightBvh<MeansNode>::kNoSlot || !(receipt.weight_sum > 0.0f)) return 0.0f;
        const Receiver x = to_local(point);
        const ClusterCut& cut = cut_of(cell_of(receipt));
        if (by_light(cut, x)) {
            return static_cast<float>(static_cast<double>(weight_of_light(cut, x, slot)) /
                                      static_cast<double>(receipt.weight_sum));
        }
        const WeightOfSlot top = weight_above(cut, x, slot);
        const double prob =
            static_cast<double>(top.weight) / static_cast<double>(receipt.weight_sum);
        return static_cast<float>(
            light_bvh_kernels<MeansNode>().prob_of_slot(lights_->bvh(), x, slot, top.slot, prob));
    }

    void report(Span<const LightOutcome> outcomes) const noexcept override {
        for (const LightOutcome& outcome : outcomes) {
            const std::uint32_t cell =
                is_cell(outcome.receipt) ? cell_of(outcome.receipt) : kEverywhere;
            cells_->report(*lights_, outcome, cell == kEverywhere ? LearnedCells::kNone : cell);
        }
    }

    bool wants_reports() const noexcept override { return cells_->learning(); }

    bool knows(const Receipt& receipt) const noexcept override {
        if (!is_cell(receipt)) return fallback_->knows(receipt);
        const std::uint32_t cell = cell_of(receipt);
        return cell < cells_->size() || (cell == kEverywhere && everywhere_ != nullptr);
    }

    std::uint32_t set_count() const noexcept override { return fallback_->set_count(); }

    SelectionCounts count(const ShadingPoint& point) const noexcept override {
        const std::uint32_t cell = find(point);
        if (!has_cut(cell)) return sampler_info(*fallback_)->count(point);
        SelectionCounts counts;
        const Receiver x = to_local(point);
        if (by_light(cut_of(cell), x)) {
            LightFactors factors;
            factors.set(*lights_->rows, lights_->leaves, cut_of(cell));
            LightWeights weights;
            cut_kernels().weigh_lights(*lights_->rows, factors, x, weights);
            const std::size_t places = lights_->rows->rows().size() * LightRows::kColumns;
            counts.lights_tested = lights_->leaves.size();
            counts.accepted = static_cast<std::uint32_t>(std::count_if(
                weights.of, weights.of + places, [](float weight) { return weight > 0.0f; }));
            return counts;
        }
        CutWeights weights;
        weigh(cell, x, weights);
        counts.lights_tested = cut_of(cell).size + weights.opened_count * CutWeights::kWidth;
        for (std::uint32_t i = 0; i < weights.size; ++i) {
            counts.accepted += weights.of[i] > 0.0f ? 1 : 0;
        }
        return counts;
    }

    std::size_t memory_size() const noexcept override {
        return sampler_info(*fallback_)->memory_size() + lights_->leaves.memory_size() +
               cells_->memory_size();
    }
    std::size_t memory_limit() const noexcept override {
        return memory_size() - cells_->memory_size() + cells_->memory_limit();
    }
    std::size_t cell_count() const noexcept override { return cells_->size(); }
    std::size_t cell_memory_size() const noexcept override { return cells_->memory_size(); }
    std::uint32_t cell_of(const ShadingPoint& point) const noexcept override {
        return cells_->cell_at(lights_->frame.position(point.position), point.normal);
    }
    float learned_visibility(const ShadingPoint& point,
                             std::uint32_t light) const noexcept override {
        constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
        const std::uint32_t cell = cell_of(point);
        const LightBvhSlot slot = lights_->bvh().slots[light];
        if (cell == kNoCell || slot == LightBvh<MeansNode>::kNoSlot) return kUnknown;
        const ClusterCut& cut = cells_->cut(cell);
        const std::uint32_t cluster = cut.cluster_of_leaf(lights_->leaves.first(slot));
        const float visible = cut.visible[cluster];
        const bool tried = visible < 1.0f;
        const bool may_light =
            cut_kernels().weight_of(cut, cut.place_of[cluster], to_local(point)) > 0.0f;
        return tried && may_light ? visible * visible : kUnknown;
    }

  private:
    static constexpr std::size_t kBlock = 8192;
    static_assert(kNoCell == LearnedCells::kNone);
    static constexpr std::uint32_t kIsCell = 0x80000000u;
    /// What stands in a receipt in place of a cell where there is none.
    static constexpr std::uint32_t kEverywhere = ~kIsCell;

    /// True if a cut serves a cell, or what find() gives where there is none.
    bool has_cut(std::uint32_t cell) const noexcept {
        return cell < cells_->size() || everywhere_ != nullptr;
    }
    const ClusterCut& cut_of(std::uint32_t cell) const noexcept {
        const ClusterCut* const cut = cell < cells_->size() ? &cells_->cut(cell) : everywhere_;
        assert(cut != nullptr);
        return *cut;
    }
    std::uint32_t key_of(std::uint32_t cell) const noexcept {
        return kIsCell | (cell < cells_->size() ? cell : kEverywhere);
    }
    static bool is_cell(const Receipt& receipt) noexcept { return (receipt.key & kIsCell) != 0; }
    static std::uint32_t cell_of(const Receipt& receipt) noexcept { return receipt.key & ~kIsCell; }
    /// A key has a cell in the upper half, and the index of a point in the lower.
    static std::uint32_t cell_of(std::uint64_t key) noexcept {
        return static_cast<std::uint32_t>(key >> 32);
    }
    static std::uint32_t index_of(std::uint64_t key) noexcept {
        return static_cast<std::uint32_t>(key);
    }
    /// True for a point that `culled` serves, of which the key has the number of cells.
    bool is_elsewhere(std::uint64_t key) const noexcept { return !has_cut(cell_of(key)); }
    std::uint32_t find(const ShadingPoint& point) const noexcept {
        return cells_->find(lights_->frame.position(point.position), point.normal);
    }
    Receiver to_local(const ShadingPoint& point) const noexcept { return {lights_->frame, point}; }

    /// Weighs the clusters of a cell.
    void weigh(std::uint32_t cell, const Receiver& x, CutWeights& weights) const noexcept {
        cut_kernels().weigh(lights_->bvh(), cut_of(cell), x, weights);
    }

    /// True if each light is weighed at a receiver: where a cut misjudges it. Which of a cluster
    /// lie in a lobe is told for so many lights in no more time than by opening it.
    bool by_light(const ClusterCut& cut, const Receiver& x) const noexcept {
        constexpr std::uint32_t kFewForLobes = 512;
        return lights_->rows &&
               (cut.by_light || (x.has_lobe() && lights_->leaves.size() <= kFewForLobes));
    }

    float weight_of_light(const ClusterCut& cut, const Receiver& x,
                          LightBvhSlot slot) const noexcept {
        const std::uint32_t leaf = lights_->leaves.first(slot);
        const std::size_t place = lights_->rows->place_of_leaf(leaf);
        return cut_kernels().importance_of_light(*lights_->rows, place, x) *
               cut.visible[cut.cluster_of_leaf(leaf)];
    }

    /// factors: those of the cell's cut.
    Selection select_by_light(std::uint32_t cell, const LightFactors& factors, const Receiver& x,
                              double number) const noexcept {
        LightWeights weights;
        cut_kernels().weigh_lights(*lights_->rows, factors, x, weights);
        const Receipt receipt{weights.total, key_of(cell)};
        if (!(weights.total > 0.0f)) return {0, 0.0f, 0.0f, receipt};
        const LightChoice choice = choose(*lights_->rows, weights, number);
        const auto prob = static_cast<float>(choice.prob);
        return {choice.child & ~LightBvhNode::kLight, prob, prob, receipt};
    }

    /// A slot of the tree, and the weight of the cluster that it holds.
    struct WeightOfSlot {
        LightBvhSlot slot;
        float weight;
    };

    /// What was weighed in a cell of the clusters above the slot of a light.
    WeightOfSlot weight_above(const ClusterCut& cut, const Receiver& x,
                              LightBvhSlot slot) const noexcept {
        const std::uint32_t cluster = cut.cluster_of_leaf(lights_->leaves.first(slot));
        const std::uint32_t place = cut.place_of[cluster];
        if (!x.has_lobe()) return {cut.slot[cluster], cut_kernels().weight_of(cut, place, x)};
        CutWeights weights;
        cut_kernels().weigh(lights_->bvh(), cut, x, weights);
        const auto begin = std::begin(weights.opened), end = begin + weights.opened_count;
        for (; slot != cut.slot[cluster];
             slot = lights_->bvh().parents[slot / CutWeights::kWidth]) {
            const auto found = std::find(begin, end, slot / CutWeights::kWidth);
            if (found == end) continue;
            const auto k = static_cast<std::uint32_t>(found - begin);
            return {slot, weights.of[weights.first_opened + k * CutWeights::kWidth +
                                     slot % CutWeights::kWidth]};
        }
        return {slot, weights.of[place]};
    }

    /// Chooses one of them, at which a descent starts.
    void choose_cluster(std::uint32_t cell, const CutWeights& weights, double number,
                        LightBvhDescent& descent) const noexcept {
        descent.prob = 0.0;
        descent.child = LightBvhNode::kLight;
        if (!(weights.total() > 0.0f)) return;
        const ClusterCut& cut = cut_of(cell);
        const CutChoice choice = choose(cut, weights, number);
        descent.place = choice.within;
        descent.prob =
            static_cast<double>(weights.of[choice.place]) / static_cast<double>(weights.total());
        descent.child = weights.child(lights_->bvh(), cut, choice.place);
    }

    static Selection result(const LightBvhDescent& descent, const Receipt& receipt) noexcept {
        if (!(descent.prob > 0.0)) return {0, 0.0f, 0.0f, receipt};
        const auto prob = static_cast<float>(descent.prob);
        return {descent.child & ~LightBvhNode::kLight, prob, prob, receipt};
    }

    /// Selects for the points of blocks, which are in keys with their cells, those without one
    /// last.
    void select_in_cells(Span<const std::uint64_t> keys, Span<const ShadingPoint> points,
                         Span<const float> u, Span<Selection> selections) const noexcept {
        const auto end = static_cast<std::size_t>(
            std::find_if(keys.begin(), keys.end(), [&](auto key) { return is_elsewhere(key); }) -
            keys.begin());
        for (std::size_t begin = 0; begin < end; begin += kMaxDescents) {
            const std::size_t count = std::min(kMaxDescents, end - begin);
            std::array<LightBvhDescent, kMaxDescents> descents;
            std::array<CutWeights, kMaxDescents> weights;
            // One step for all of them, and then the next: no step waits for the one before.
            for (std::size_t k = 0; k < count; ++k) {
                descents[k].receiver = to_local(points[index_of(keys[begin + k])]);
                weigh(cell_of(keys[begin + k]), descents[k].receiver, weights[k]);
            }
            for (std::size_t k = 0; k < count; ++k) {
                const std::uint32_t i = index_of(keys[begin + k]);
                choose_cluster(cell_of(keys[begin + k]), weights[k], refine(u[i], points[i]),
                               descents[k]);
            }
            light_bvh_kernels<MeansNode>().descend(lights_->bvh(), {descents.data(), count});
            for (std::size_t k = 0; k < count; ++k) {
                selections[index_of(keys[begin + k])] =
                    result(descents[k], {weights[k].total(), key_of(cell_of(keys[begin + k]))});
            }
        }
    }

    /// Selects for those of the points at which each light is weighed, and returns the number of
    /// others, whose keys go to the front.
    std::size_t select_by_light(Span<std::uint64_t> keys, Span<const ShadingPoint> points,
                                Span<const float> u, Span<Selection> selections) const noexcept {
        if (!lights_->rows) return keys.size();
        LightFactors factors;
        const ClusterCut* known = nullptr;
        std::size_t others = 0;
        for (const std::uint64_t key : keys) {
            const std::uint32_t cell = cell_of(key), i = index_of(key);
            const Receiver x = to_local(points[i]);
            if (is_elsewhere(key) || !by_light(cut_of(cell), x)) {
                keys[others++] = key;
                continue;
            }
            if (known != &cut_of(cell)) {
                known = &cut_of(cell);
                factors.set(*lights_->rows, lights_->leaves, *known);
            }
            selections[i] = select_by_light(cell, factors, x, refine(u[i], points[i]));
        }
        return others;
    }

    /// Selects for the points that no cut serves.
    void select_elsewhere(const std::vector<std::uint64_t>& keys, Span<const ShadingPoint> points,
                          Span<const float> u, Span<Selection> selections) const {
        const auto elsewhere = static_cast<std::size_t>(
            std::count_if(keys.begin(), keys.end(), [&](auto key) { return is_elsewhere(key); }));
        if (elsewhere == 0) return;
        if (elsewhere == points.size()) {
            fallback_->select(points, u, selections);
            return;
        }
        std::vector<std::uint32_t> indices;
        std::vector<ShadingPoint> some;
        std::vector<float> numbers;
        indices.reserve(elsewhere);
        some.reserve(elsewhere);
        numbers.reserve(elsewhere);
        for (const std::uint64_t key : keys) {
            if (!is_elsewhere(key)) continue;
            indices.push_back(index_of(key));
            some.push_back(points[index_of(key)]);
            numbers.push_back(u[index_of(key)]);
        }
        std::vector<Selection> chosen(elsewhere);
        fallback_->select(some, numbers, chosen);
        for (std::size_t i = 0; i < elsewhere; ++i) selections[indices[i]] = chosen[i];
    }

    std::shared_ptr<const LightSelector> fallback_;
    std::shared_ptr<const LearnedLights> lights_;
    std::shared_ptr<LearnedCells> cells_;
    const ClusterCut* everywhere_;
};

class LearnedSampler final : public LightSampler, public SamplerInfo {
  public:
    LearnedSampler(std::shared_ptr<CulledSamplerBase> culled, const LearningLimits& limits)
        : culled_(std::move(culled)),
          limits_(limits),
          lights_(std::make_shared<const LearnedLights>(culled_->scene().frame, culled_->groups())),
          cells_(no_cells()) {
        renew();
    }

    void begin_pass(std::uint64_t pass) override {
        culled_->begin_pass(pass);
        ++passes_;
        if (!cells_->due()) return;
        current_.reset();
        if (cells_.use_count() > 1) cells_ = std::make_shared<LearnedCells>(*cells_);
        cells_->learn(*lights_);
        renew();
    }
    std::unique_ptr<const LightSelector> pass(std::uint64_t number) const override {
        return std::make_unique<LearnedPass>(culled_->pass(number), lights_, cells_, everywhere());
    }
    LightUpdate update(Span<const Light> lights, float max_growth) override {
        const LightUpdate result = culled_->update(lights, max_growth);
        lights_ = std::make_shared<const LearnedLights>(culled_->scene().frame, culled_->groups());
        current_.reset();
        cells_ = result.rebuilt ? no_cells() : std::make_shared<LearnedCells>(*cells_);
        cells_->refresh(*lights_);
        cells_->learn_anew();
        renew();
        return result;
    }
    void drop_reports() noexcept override { cells_->drop_reports(); }

    std::vector<std::uint8_t> learned() const override {
        ByteWriter out;
        out.write(kStateVersion);
        out.write(lights_->digest());
        out.write(passes_);
        cells_->save(out);
        return out.take();
    }
    void restore_learned(Span<const std::uint8_t> bytes) override {
        ByteReader in(bytes);
        if (in.read<std::uint64_t>() != kStateVersion) {
            throw Error("learned: these bytes are of another version, or no state at all");
        }
        if (in.read<std::uint64_t>() != lights_->digest()) {
            throw Error("learned: this state was learned over other lights");
        }
        const auto passes = in.read<std::uint64_t>();
        std::shared_ptr<LearnedCells> cells = LearnedCells::load(in, limits_, *lights_);
        if (cells == nullptr) throw Error("learned: this state makes no sense");
        passes_ = passes;
        current_.reset();
        cells_ = std::move(cells);
        renew();
    }

    using LightSampler::select;
    Selection select(const ShadingPoint& point, float u) const noexcept override {
        return current_->select(point, u);
    }
    void select(Span<const ShadingPoint> points, Span<const float> u,
                Span<Selection> selections) const override {
        current_->select(points, u, selections);
    }
    float prob(const ShadingPoint& point, const Receipt& receipt,
               std::uint32_t light) const noexcept override {
        return current_->prob(point, receipt, light);
    }
    void report(Span<const LightOutcome> outcomes) const noexcept override {
        current_->report(outcomes);
    }
    bool wants_reports() const noexcept override {
        // Later passes tell less that is new, and reports take time.
        constexpr std::uint32_t kAll = 32, kOneIn = 4;
        return cells_->learning() && (cells_->round() < kAll || passes_ % kOneIn == 0);
    }
    bool knows(const Receipt& receipt) const noexcept override { return current_->knows(receipt); }
    std::uint32_t set_count() const noexcept override { return culled_->set_count(); }
    SelectionCounts count(const ShadingPoint& point) const noexcept override {
        return current_->count(point);
    }
    std::size_t memory_size() const noexcept override { return current_->memory_size(); }
    std::size_t memory_limit() const noexcept override { return current_->memory_limit(); }
    std::size_t cell_count() const noexcept override { return cells_->size(); }
    std::size_t cell_memory_size() const noexcept override { return cells_->memory_size(); }
    bool learning() const noexcept override { return cells_->will_learn_more(); }
    std::uint32_t cell_of(const ShadingPoint& point) const noexcept override {
        return current_->cell_of(point);
    }
    float learned_visibility(const ShadingPoint& point,
                             std::uint32_t light) const noexcept override {
        return current_->learned_visibility(point, light);
    }

  private:
    static constexpr std::uint64_t kStateVersion = 0x31306c6c7563u;

    /// Among so few there is less to gain by learning than it costs.
    bool are_few() const noexcept { return lights_->leaves.size() <= 4; }
    bool learns() const noexcept { return limits_.rounds > 0 && !are_few(); }
    std::shared_ptr<LearnedCells> no_cells() const {
        return std::make_shared<LearnedCells>(
            LearningLimits{limits_.memory, learns() ? limits_.rounds : 0});
    }
    /// The cut for points that are in no cell, null if `culled` is better for them.
    const ClusterCut* everywhere() const noexcept {
        return (learns() || are_few()) && lights_->everywhere ? &*lights_->everywhere : nullptr;
    }
    void renew() {
        current_ = std::make_unique<LearnedPass>(culled_, lights_, cells_, everywhere());
    }

    std::shared_ptr<CulledSamplerBase> culled_;
    LearningLimits limits_;
    std::shared_ptr<const LearnedLights> lights_;
    std::shared_ptr<LearnedCells> cells_;
    std::unique_ptr<const LearnedPass> current_;
    std::uint64_t passes_ = 0;  ///< number of passes begun
};

}  // namespace

std::unique_ptr<LightSampler> make_learned_sampler(const LearnedOptions& options,
                                                   Span<const Light> lights,
                                                   const SamplerContext& context) {
    const std::shared_ptr<LightSampler> culled = make_culled_sampler({}, lights, context);
    auto base = std::dynamic_pointer_cast<CulledSamplerBase>(culled);
    if (base == nullptr) {
        throw Error("learned: glossy points are among the lights, for which there is culled");
    }
    // Clusters of narrow cones say less of a place than what may be learned about them. Where all
    // lights are weighed, there are none.
    constexpr float kNarrow = 0.45f;
    const auto lit = std::count_if(lights.begin(), lights.end(),
                                   [](const Light& light) { return light.intensity > 0.0f; });
    const bool has_clusters = lit > std::ptrdiff_t{ClusterCut::kMaxSize};
    const bool is_narrow =
        has_clusters && share_of_narrow_cones(lights, kNarrow) > kManyNarrowCones;
    const std::uint32_t rounds = is_narrow ? 0 : options.rounds;
    return std::make_unique<LearnedSampler>(
        std::move(base), LearningLimits{std::size_t{options.memory_mib} << 20, rounds});
}

}  // namespace lightcull
