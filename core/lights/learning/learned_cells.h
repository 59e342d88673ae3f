#pragma once

#include <lightcull/light_sampler.h>
#include <lightcull/span.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "base/byte_stream.h"
#include "lights/groups/light_groups.h"
#include "lights/learning/cell_grid.h"
#include "lights/learning/cluster_cut.h"
#include "lights/learning/cut_builder.h"
#include "lights/learning/leaf_order.h"
#include "lights/learning/light_rows.h"
#include "lights/learning/new_cells.h"
#include "lights/light/light_record.h"

namespace lightcull {

/// The lights that cells choose from.
struct LearnedLights {
    Frame frame;
    std::shared_ptr<const LightGroups> groups;
    LeafOrder leaves;
    /// Each light, where there are few enough to weigh them all, and more than a cut holds.
    std::optional<LightRows> rows;
    /// A cut for all points, where there are few enough lights for it.
    std::optional<ClusterCut> everywhere;

    LearnedLights(const Frame& f, std::shared_ptr<const LightGroups> g);

    const LightBvh<MeansNode>& bvh() const noexcept { return groups->bvh; }
    /// A hash of all that cells know of the lights.
    std::uint64_t digest() const noexcept;
};

/// Bounds on learning.
struct LearningLimits {
    std::size_t memory;    ///< most bytes of all cells
    std::uint32_t rounds;  ///< number of rounds after which nothing changes any more; 0: none do
};

/// The cells of space, each with its cut and what was learned of it. Reports are collected from any
/// thread, and change nothing until learn() is called.
///
/// Cells are made where points were met, and divided where many are. New ones take over what the
/// cell knows that they are part of. When memory is full, no more are made, and those there are go
/// on learning. Where points lie in more places than can be counted before there is any cell, cells
/// are to be of twice the size.
class LearnedCells {
  public:
    static constexpr std::uint32_t kNone = CellTree::kNone;

    explicit LearnedCells(const LearningLimits& limits);
    LearnedCells(const LearnedCells& other);
    LearnedCells& operator=(const LearnedCells&) = delete;

    /// The cell whose cut serves a point, whose position is in the units of the lights; kNone where
    /// none has been made.
    std::uint32_t find(const float3& position, const float3& normal) const noexcept {
        std::uint32_t hint = kNone;
        return find(position, normal, hint);
    }
    /// The same; faster where the points of calls with one hint, kNone at first, are neighbours.
    std::uint32_t find(const float3& position, const float3& normal,
                       std::uint32_t& hint) const noexcept;
    /// The cell that a point lies in: find() may give one that is near.
    std::uint32_t cell_at(const float3& position, const float3& normal) const noexcept {
        return tree_.find(lattice_.place(position, normal));
    }
    const ClusterCut& cut(std::uint32_t cell) const noexcept { return cuts_[cell]; }
    std::uint32_t size() const noexcept { return tree_.size(); }

    /// Collects an outcome. cell: the cell that served the point, or kNone.
    void report(const LearnedLights& lights, const LightOutcome& outcome,
                std::uint32_t cell) noexcept;
    void drop_reports() noexcept;
    /// False when learning has come to rest.
    bool learning() const noexcept { return new_cells_ != nullptr; }

    /// False when learning will have come to rest by the end of this round.
    bool will_learn_more() const noexcept {
        return learning() && round_ + (due() ? 1 : 0) < limits_.rounds;
    }

    /// The number of rounds that have ended.
    std::uint32_t round() const noexcept { return round_; }
    /// Ends a round: from time to time, what has been reported changes the cells. Runs in the
    /// caller's TBB arena; the result does not depend on it.
    void learn(const LearnedLights& lights);
    /// Fits the cuts to lights that have moved in a tree of the same topology.
    void refresh(const LearnedLights& lights);
    /// Begins the rounds anew, since what was learned may not be so any more: it counts for no more
    /// than a few rays to each cluster. Reports since the last learn() are forgotten.
    void learn_anew();
    /// True if the next learn() may change the cells.
    bool due() const noexcept;

    /// Writes all that learning goes on from, reports included.
    void save(ByteWriter& out) const;
    /// Cells that go on as those did which were saved. Null for what makes no sense for the lights.
    static std::shared_ptr<LearnedCells> load(ByteReader& in, const LearningLimits& limits,
                                              const LearnedLights& lights);

    std::size_t memory_size() const noexcept;
    /// The most that memory_size() may become.
    std::size_t memory_limit() const noexcept;

  private:
    /// The shadow rays to each cluster in the round: tries in the lower half, and hits in
    /// kParts in the upper.
    struct Fresh {
        std::atomic<std::uint64_t> of[ClusterCut::kMaxSize]{};
    };
    static constexpr float kParts = 64.0f;
    /// Points are sorted by their cell in 20 bits.
    static constexpr std::uint32_t kMostCells = (1u << 20) - 1;

    void take_reports();
    /// Lets finer cells be made within a cell, if there are any.
    void divide(std::uint32_t cell);
    void rebuild_cuts(const LearnedLights& lights);
    void make_cells(const LearnedLights& lights);
    /// Adds a cell, without its cut; returns the one that it is part of, or kNone.
    std::uint32_t add_cell(const MetCell& met);
    /// The most cells that there may be.
    std::size_t most_cells() const noexcept;
    void save_cell(ByteWriter& out, std::uint32_t cell) const;
    bool load_cell(ByteReader& in, const LearnedLights& lights);

    LearningLimits limits_;
    CellLattice lattice_;
    CellTree tree_;
    std::vector<CutPlace> places_;
    std::vector<ClusterCut> cuts_;
    std::vector<CutEvidence> evidence_;
    std::unique_ptr<Fresh[]> fresh_;
    std::unique_ptr<NewCells> new_cells_;  ///< null when learning has come to rest
    std::atomic<bool> reported_{false};    ///< there were reports since the last round
    std::uint32_t round_ = 0;              ///< rounds with reports so far
    std::uint32_t published_ = 0;          ///< round in which the cells last changed
};

}  // namespace lightcull
