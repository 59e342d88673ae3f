#pragma once

#include "base/alias_table.h"
#include "base/core_export.h"
#include "base/memory_size.h"
#include "render/vec.h"

#include <lightcull/render/scene.h>

#include <cstdint>
#include <vector>

namespace lightcull {

/// What an environment gives from a direction.
struct EnvironmentValue {
    V3f radiance{0.0f};
    float pdf = 0.0f;  ///< density of EnvironmentMap::sample(), per solid angle
};

struct EnvironmentSample {
    V3f direction{0.0f};  ///< sampled direction, unit length
    V3f radiance{0.0f};
    float pdf = 0.0f;  ///< density per solid angle; 0: the environment is black
};

/// An environment map that can be looked up and sampled in proportion to what it gives.
class LIGHTCULL_CORE_EXPORT EnvironmentMap {
  public:
    explicit EnvironmentMap(Environment environment);

    /// direction: unit length.
    EnvironmentValue at(const V3f& direction) const noexcept;
    /// cell and u in [0, 1).
    EnvironmentSample sample(double cell, const V2f& u) const noexcept;

    /// What it was made of.
    Environment description() const;

    /// The memory that the map takes, bytes.
    std::size_t memory_size() const noexcept {
        return size_of(map_.texels) + cells_.memory_size() + size_of(pdfs_) +
               size_of(edge_cosines_);
    }

  private:
    V2f to_map(const V3f& direction) const noexcept;
    V3f lookup(const V2f& place) const noexcept;
    float density(const V2f& place) const noexcept;

    Texture map_;
    V3f scale_;
    float cos_rotation_, sin_rotation_;

    // Inside a texel's cell the density is constant per solid angle: it is the mean luminance
    // there, which is 0 only where every lookup is.
    AliasTable cells_;  // empty: the environment is black
    std::vector<float> pdfs_;
    std::vector<double> edge_cosines_;  // cosines of the angles to +Y at the edges of rows of cells
};

}  // namespace lightcull
