#include <cstring>

#include "base/random.h"
#include "lights/learning/learned_cells.h"

// How LearnedCells are saved and loaded. What follows from the lights' tree is not saved.

namespace lightcull {
namespace {

/// True if the clusters of a cut hold all lights of the tree once, in the order of its leaves.
bool is_whole(const ClusterCut& cut, const LearnedLights& lights) noexcept {
    const LightBvh<MeansNode>& bvh = lights.bvh();
    constexpr std::uint32_t kWidth = LightBvhNode::kWidth;
    std::uint32_t next = 0;
    for (std::uint32_t i = 0; i < cut.size; ++i) {
        const LightBvhSlot slot = cut.slot[i];
        if (slot / kWidth >= bvh.nodes.size()) return false;
        if (bvh.nodes[slot / kWidth].child[slot % kWidth] == LightBvhNode::kEmpty) return false;
        if (lights.leaves.first(slot) != next) return false;
        next = lights.leaves.end(bvh, slot);
    }
    return next == lights.leaves.size();
}

bool is_part(float x) noexcept {
    return x >= 0.0f && x <= 1.0f;
}

void save(ByteWriter& out, const MetCell& cell) {
    out.write(cell.key);
    out.write(cell.count);
    out.write(cell.offset);
    out.write(cell.normal);
}

MetCell load_met_cell(ByteReader& in) noexcept {
    MetCell cell{in.read<CellKey>(), in.read<std::uint32_t>(), {}, {}};
    for (auto& sum : cell.offset) sum = in.read<std::int64_t>();
    for (auto& sum : cell.normal) sum = in.read<std::int64_t>();
    return cell;
}

}  // namespace

std::uint64_t LearnedLights::digest() const noexcept {
    std::uint64_t digest = bvh().slots.size();
    for (const MeansNode& node : bvh().nodes) {
        std::uint64_t words[sizeof node / sizeof(std::uint64_t)];
        std::memcpy(words, &node, sizeof node);
        for (const std::uint64_t word : words) digest = mix(digest ^ word);
    }
    return digest;
}

void LearnedCells::save(ByteWriter& out) const {
    out.write(lattice_.edge(0));
    out.write(round_);
    out.write(published_);
    out.write(std::uint8_t{learning()});
    out.write(std::uint8_t{reported_});
    out.write(size());
    for (std::uint32_t cell = 0; cell < size(); ++cell) save_cell(out, cell);
    if (!learning()) return;
    const std::vector<MetCell> met = new_cells_->cells();
    out.write(static_cast<std::uint32_t>(met.size()));
    for (const MetCell& cell : met) lightcull::save(out, cell);
}

void LearnedCells::save_cell(ByteWriter& out, std::uint32_t cell) const {
    const ClusterCut& cut = cuts_[cell];
    out.write(tree_.key(cell));
    out.write(std::uint8_t{tree_.is_divided(cell)});
    out.write(places_[cell]);
    out.write(cut.size);
    for (std::uint32_t i = 0; i < cut.size; ++i) {
        out.write(cut.slot[i]);
        out.write(cut.visible[i]);
        if (!learning()) continue;
        out.write(evidence_[cell].of[i]);
        out.write(fresh_[cell].of[i].load(std::memory_order_relaxed));
    }
}

std::shared_ptr<LearnedCells> LearnedCells::load(ByteReader& in, const LearningLimits& limits,
                                                 const LearnedLights& lights) {
    const auto cells = std::make_shared<LearnedCells>(limits);
    const auto edge = in.read<float>();
    if (!(edge > 0.0f && edge < 1e6f)) return nullptr;
    cells->lattice_ = CellLattice(edge);
    cells->round_ = in.read<std::uint32_t>();
    cells->published_ = in.read<std::uint32_t>();
    if (in.read<std::uint8_t>() == 0) cells->new_cells_.reset();
    cells->reported_ = in.read<std::uint8_t>() != 0;
    const auto count = in.read<std::uint32_t>();
    // A cell takes more bytes than one, so that a number out of thin air asks for no memory.
    if (!in.ok() || count > in.left() || count > kMostCells) return nullptr;
    if (cells->learning()) {
        cells->fresh_.reset(new Fresh[count]);
        cells->evidence_.reserve(count);
    }
    for (std::uint32_t cell = 0; cell < count; ++cell) {
        if (!cells->load_cell(in, lights)) return nullptr;
    }
    cells->refresh(lights);
    if (cells->learning()) {
        std::vector<MetCell> met;
        for (auto left = in.read<std::uint32_t>(); left > 0 && in.ok(); --left) {
            met.push_back(load_met_cell(in));
        }
        cells->new_cells_->restore(met);
    }
    return in.ok() && in.left() == 0 ? cells : nullptr;
}

bool LearnedCells::load_cell(ByteReader& in, const LearnedLights& lights) {
    const auto key = in.read<CellKey>();
    if (!tree_.may_add(key)) return false;
    const std::uint32_t cell = tree_.add(key);
    const bool divided = in.read<std::uint8_t>() != 0;
    if (divided && CellLattice::level_of(key) == CellLattice::kFinest) return false;
    if (divided) tree_.divide(cell);
    places_.push_back(in.read<CutPlace>());
    ClusterCut& cut = cuts_.emplace_back();
    if (learning()) evidence_.emplace_back();
    const auto size = in.read<std::uint32_t>();
    if (size > ClusterCut::kMaxSize) return false;
    for (std::uint32_t i = 0; i < size; ++i) {
        cut.slot[i] = in.read<LightBvhSlot>();
        cut.visible[i] = in.read<float>();
        if (!is_part(cut.visible[i]) || cut.visible[i] < kLeastVisible) return false;
        if (!learning()) continue;
        const Evidence& known = evidence_[cell].of[i] = in.read<Evidence>();
        if (!(known.hits >= 0.0f && known.hits <= known.tries)) return false;
        fresh_[cell].of[i].store(in.read<std::uint64_t>(), std::memory_order_relaxed);
    }
    cut.size = size;
    if (!in.ok() || !is_whole(cut, lights)) return false;
    for (std::uint32_t i = 0; i < size; ++i) cut.first_leaf[i] = lights.leaves.first(cut.slot[i]);
    return true;
}

}  // namespace lightcull
