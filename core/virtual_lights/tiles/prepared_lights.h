#pragma once

#include "render/camera.h"
#include "virtual_lights/light/virtual_light.h"
#include "virtual_lights/tiles/tile_bounds.h"
#include "virtual_lights/volumes/acceptance.h"
#include "virtual_lights/volumes/box_tree.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lightcull {

/// The lights of a pass, and the numbers about them that do not depend on the pixel. The lights of
/// a subset, every count-th, lie together, and among them the lights of like ranges, neighbours
/// side by side: so the lights of a tile are found without a look at all others.
class PreparedLights {
  public:
    /// Prepares lights. Those that lie near each other should follow each other. Runs in the
    /// caller's TBB arena.
    PreparedLights(const std::vector<VirtualLight>& lights, const Acceptance& acceptance,
                   BoundingVolume volume, const CameraRays& camera, std::uint32_t subsets);

    std::uint32_t subsets() const noexcept { return static_cast<std::uint32_t>(trees_.size()); }
    const VirtualLight& light(std::size_t i) const noexcept { return lights_[i]; }
    const Acceptance::OfLight& of_light(std::size_t i) const noexcept { return of_light_[i]; }
    const std::vector<VirtualLight>& all() const noexcept { return lights_; }

    /// A light, and a distance from it beyond which it counts nowhere.
    struct Listed {
        V3f position;
        float farthest2;  ///< square of that distance
        std::uint32_t index;
    };
    Listed listed(std::size_t i) const noexcept {
        return {lights_[i].position, farthest2_[i], static_cast<std::uint32_t>(i)};
    }
    /// The box that encloses the places where a light may count; only where there are ranges.
    const AlignedBox& box(std::size_t i) const noexcept { return boxes_[i]; }
    /// The number of the first light of a subset, or the number behind the last subset's last.
    std::size_t begin(std::uint32_t subset) const noexcept { return begins_[subset]; }

    /// Lights as Listed, one array per quantity: a place is compared with many of them at a time.
    struct List {
        std::vector<float> x, y, z, farthest2;
        std::vector<std::uint32_t> index;

        std::size_t size() const noexcept { return index.size(); }
        void add(const Listed& light);
    };

    /// The lights of a subset that may count somewhere in a piece of a tile.
    List list(std::uint32_t subset, const FrustumPiece& piece) const;

  private:
    void order(const std::vector<VirtualLight>& lights, const Acceptance& acceptance,
               std::uint32_t subsets);

    std::vector<std::size_t> begins_;  // first light of each subset, and the end
    std::vector<VirtualLight> lights_;
    std::vector<Acceptance::OfLight> of_light_;
    std::vector<float> farthest2_;
    // Members that are empty where all lights count everywhere:
    std::vector<VolumeInView> volumes_;
    std::vector<AlignedBox> boxes_;
    std::vector<BoxTree> trees_;  // box trees, by subset
};

}  // namespace lightcull
