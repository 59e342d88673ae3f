#include "lights/learning/learned_cells.h"

#include <algorithm>
#include <cmath>

#include "base/float3_math.h"
#include "base/memory_size.h"
#include "base/parallel_blocks.h"

namespace lightcull {
namespace {

/// The edge of the first cells; the lights' bounds are two units wide.
constexpr float kFirstSize = 0x1p-2f;
/// A cell that this many points are met in, per round, is divided.
constexpr std::uint32_t kCrowd = 200;
/// Cells are worked on in blocks of this many.
constexpr std::size_t kBlock = 16;

/// Leaves only the `most` cells in which most points were met, in the order of their keys.
void keep_most_met(std::vector<MetCell>& cells, std::size_t most) {
    if (cells.size() <= most) return;
    std::stable_sort(cells.begin(), cells.end(),
                     [](const MetCell& a, const MetCell& b) { return a.count > b.count; });
    cells.resize(most);
    std::sort(cells.begin(), cells.end(),
              [](const MetCell& a, const MetCell& b) { return a.key < b.key; });
}

/// What a cell's evidence says of a part of it: as much as a few rays.
CutEvidence handed_down(CutEvidence evidence) noexcept {
    constexpr float kRays = 16.0f, kShare = 0.25f;
    for (Evidence& known : evidence.of) known = handed_down(known, kShare, kRays);
    return evidence;
}

/// The number of lights up to which one cut is better for all points than random ranges.
constexpr std::uint32_t kFewForOneCut = 8192;

}  // namespace

LearnedLights::LearnedLights(const Frame& f, std::shared_ptr<const LightGroups> g)
    : frame(f), groups(std::move(g)), leaves(groups->bvh) {
    if (leaves.size() > ClusterCut::kMaxSize && leaves.size() <= LightRows::kMost) {
        rows.emplace(bvh(), leaves);
    }
    if (leaves.size() == 0 || leaves.size() > kFewForOneCut) return;
    // The lights' bounds are two units wide.
    constexpr CutPlace kAll{{0, 0, 0}, {0, 0, 0}, 1.0f};
    CutEvidence none;
    everywhere.emplace();
    rebuild_cut(bvh(), leaves, kAll, *everywhere, none);
}

LearnedCells::LearnedCells(const LearningLimits& limits)
    : limits_(limits),
      lattice_(kFirstSize),
      fresh_(nullptr),
      new_cells_(limits.rounds > 0 ? std::make_unique<NewCells>() : nullptr) {
}

LearnedCells::LearnedCells(const LearnedCells& other)
    : limits_(other.limits_),
      lattice_(other.lattice_),
      tree_(other.tree_),
      places_(other.places_),
      cuts_(other.cuts_),
      evidence_(other.evidence_),
      fresh_(other.fresh_ ? new Fresh[other.size()] : nullptr),
      new_cells_(other.new_cells_ ? std::make_unique<NewCells>() : nullptr),
      reported_(other.reported_.load()),
      round_(other.round_),
      published_(other.published_) {
    for (std::size_t i = 0; fresh_ && i < size(); ++i) {
        for (std::size_t k = 0; k < ClusterCut::kMaxSize; ++k) {
            fresh_[i].of[k] = other.fresh_[i].of[k].load(std::memory_order_relaxed);
        }
    }
    if (new_cells_) new_cells_->restore(other.new_cells_->cells());
}

std::uint32_t LearnedCells::find(const float3& position, const float3& normal,
                                 std::uint32_t& hint) const noexcept {
    const CellPlace place = lattice_.place(position, normal);
    const std::uint32_t cell =
        hint != kNone && tree_.is_finest_of(hint, place) ? hint : tree_.find(place);
    hint = cell;
    if (cell == kNone) return kNone;
    const std::uint32_t near = tree_.find(jittered(place, tree_.level(cell), position));
    return near == kNone ? cell : near;
}

void LearnedCells::report(const LearnedLights& lights, const LightOutcome& outcome,
                          std::uint32_t cell) noexcept {
    if (new_cells_ == nullptr) return;
    const bool valid = outcome.visibility >= 0.0f && outcome.visibility <= 1.0f &&
                       is_finite(outcome.position) && is_finite(outcome.normal) &&
                       outcome.light < lights.bvh().slots.size() &&
                       lights.bvh().slots[outcome.light] != LightBvh<MeansNode>::kNoSlot &&
                       (cell == kNone || cell < size());
    if (!valid) return;
    if (!reported_.load(std::memory_order_relaxed)) {
        reported_.store(true, std::memory_order_relaxed);
    }
    if (cell != kNone) {
        const std::uint32_t leaf = lights.leaves.first(lights.bvh().slots[outcome.light]);
        const std::uint32_t cluster = cuts_[cell].cluster_of_leaf(leaf);
        const auto hits = static_cast<std::uint64_t>(std::lround(outcome.visibility * kParts));
        fresh_[cell].of[cluster].fetch_add((hits << 32) + 1, std::memory_order_relaxed);
        if (!tree_.is_divided(cell)) return;
    }
    const float3 x = lights.frame.position(outcome.position);
    const CellPlace place = lattice_.place(x, outcome.normal);
    const std::uint32_t found = tree_.find(place);
    if (found != kNone && !tree_.is_divided(found)) return;
    const std::uint32_t level = found == kNone ? 0 : tree_.level(found) + 1;
    new_cells_->add(lattice_, CellLattice::key(place, level), x, outcome.normal);
}

void LearnedCells::drop_reports() noexcept {
    if (!reported_) return;
    for (std::size_t i = 0; i < size(); ++i) {
        for (auto& number : fresh_[i].of) number.store(0, std::memory_order_relaxed);
    }
    if (new_cells_) new_cells_->clear();
    reported_ = false;
}

bool LearnedCells::due() const noexcept {
    return reported_;
}

void LearnedCells::learn(const LearnedLights& lights) {
    if (!reported_ || new_cells_ == nullptr) return;
    ++round_;
    take_reports();
    reported_ = false;
    const bool last = round_ >= limits_.rounds;
    // Cuts change after half as many rounds again: what is learned of a cut is of use only if the
    // cut stays for a while.
    if (round_ >= published_ + std::max(1u, published_ / 2) || last) {
        rebuild_cuts(lights);
        published_ = round_;
    }
    make_cells(lights);
    if (last) {
        new_cells_.reset();
        fresh_.reset();
        evidence_ = {};
    }
}

void LearnedCells::take_reports() {
    std::vector<std::uint8_t> crowded(size());
    for_each_block(size(), kBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            std::uint64_t count = 0;
            for (std::uint32_t k = 0; k < cuts_[i].size; ++k) {
                const std::uint64_t fresh = fresh_[i].of[k].load(std::memory_order_relaxed);
                if (fresh == 0) continue;
                fresh_[i].of[k].store(0, std::memory_order_relaxed);
                const std::uint64_t tries = fresh & 0xffffffffu;
                evidence_[i].of[k].tries += static_cast<float>(tries);
                evidence_[i].of[k].hits += static_cast<float>(fresh >> 32) / kParts;
                count += tries;
            }
            crowded[i] = count > kCrowd ? 1 : 0;
        }
    });
    for (std::uint32_t i = 0; i < size(); ++i) {
        if (crowded[i] != 0) divide(i);
    }
}

void LearnedCells::divide(std::uint32_t cell) {
    if (tree_.level(cell) < CellLattice::kFinest) tree_.divide(cell);
}

void LearnedCells::rebuild_cuts(const LearnedLights& lights) {
    for_each_block(size(), kBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            rebuild_cut(lights.bvh(), lights.leaves, places_[i], cuts_[i], evidence_[i]);
        }
    });
}

std::size_t LearnedCells::most_cells() const noexcept {
    constexpr std::size_t kPerCell =
        sizeof(CutPlace) + sizeof(ClusterCut) + sizeof(CutEvidence) + sizeof(Fresh) + 128;
    return std::min<std::size_t>(limits_.memory / kPerCell, kMostCells);
}

void LearnedCells::make_cells(const LearnedLights& lights) {
    if (new_cells_->empty()) return;
    if (new_cells_->full()) {
        new_cells_->clear();
        if (size() == 0) lattice_ = CellLattice(2.0f * lattice_.edge(0));
        return;
    }
    std::vector<MetCell> met = new_cells_->cells();
    new_cells_->clear();
    const std::size_t most = most_cells();
    keep_most_met(met, most - std::min<std::size_t>(size(), most));
    if (met.empty()) return;
    // Vectors that grow by themselves may take twice what they hold.
    places_.reserve(most);
    cuts_.reserve(most);
    evidence_.reserve(most);
    const std::size_t first = size();
    std::vector<std::uint32_t> parents;
    parents.reserve(met.size());
    for (const MetCell& cell : met) parents.push_back(add_cell(cell));
    cuts_.resize(size());
    evidence_.resize(size());
    for_each_block(met.size(), kBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const std::size_t cell = first + i;
            if (parents[i] != kNone) {
                cuts_[cell] = cuts_[parents[i]];
                evidence_[cell] = handed_down(evidence_[parents[i]]);
            }
            rebuild_cut(lights.bvh(), lights.leaves, places_[cell], cuts_[cell], evidence_[cell]);
        }
    });
    fresh_.reset(new Fresh[size()]);
}

std::uint32_t LearnedCells::add_cell(const MetCell& met) {
    const std::uint32_t level = CellLattice::level_of(met.key);
    const float scale = 1.0f / (static_cast<float>(met.count) * MetCell::kParts);
    const auto mean = [&](const std::int64_t(&sums)[3]) {
        return float3{static_cast<float>(sums[0]), static_cast<float>(sums[1]),
                      static_cast<float>(sums[2])} *
               scale;
    };
    const float edge = lattice_.edge(level);
    const float3 position = lattice_.corner(met.key) + mean(met.offset) * edge;
    const float3 mean_normal = mean(met.normal);
    // Where normals differ, light may come from anywhere.
    constexpr float kAlike = 0.95f;
    const float long_enough = length(mean_normal);
    const float3 normal =
        long_enough > kAlike ? mean_normal * (1.0f / long_enough) : float3{0, 0, 0};
    const std::uint32_t parent = level == 0 ? kNone : tree_.parent_of(met.key);
    const std::uint32_t cell = tree_.add(met.key);
    places_.push_back({position, normal, 0.5f * edge});
    if (met.count > kCrowd) divide(cell);
    return parent;
}

void LearnedCells::refresh(const LearnedLights& lights) {
    for_each_block(size(), kBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            refresh_cut(lights.bvh(), lights.leaves, places_[i], cuts_[i]);
        }
    });
}

void LearnedCells::learn_anew() {
    if (limits_.rounds == 0) return;
    constexpr float kRays = 8.0f;
    if (learning()) {
        drop_reports();
    } else {
        new_cells_ = std::make_unique<NewCells>();
        fresh_.reset(new Fresh[size()]);
        evidence_.reserve(most_cells());
        evidence_.resize(size());
        for (std::size_t i = 0; i < size(); ++i) {
            for (std::uint32_t k = 0; k < cuts_[i].size; ++k) {
                evidence_[i].of[k] = evidence_of(cuts_[i].visible[k], kRays);
            }
        }
    }
    for (CutEvidence& cell : evidence_) {
        for (Evidence& known : cell.of) known = known.at_most(kRays);
    }
    round_ = published_ = 0;
}

std::size_t LearnedCells::memory_size() const noexcept {
    return tree_.memory_size() + size_of(places_) + size_of(cuts_) + size_of(evidence_) +
           (fresh_ ? size() * sizeof(Fresh) : 0) + (new_cells_ ? NewCells::memory_size() : 0);
}

std::size_t LearnedCells::memory_limit() const noexcept {
    const std::size_t now = memory_size();
    return new_cells_ ? std::max(now, limits_.memory + NewCells::memory_size()) : now;
}

}  // namespace lightcull
