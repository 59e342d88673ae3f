#pragma once

#include "render/vec.h"

#include <lightcull/render/scene.h>

#include <array>
#include <cstdint>

namespace lightcull {

/// A shared mesh in one of its places.
struct Instance {
    Instance(MeshId m, const Placement& p) noexcept;

    V3f at(const V3f& p) const noexcept {
        return V3f(rows[0].dot(p), rows[1].dot(p), rows[2].dot(p)) + translation;
    }
    /// Bounds what the coordinates of at(p) are sums of.
    V3f magnitude_at(const V3f& p) const noexcept {
        const V3f q = abs(p);
        return V3f(abs(rows[0]).dot(q), abs(rows[1]).dot(q), abs(rows[2]).dot(q)) +
               abs(translation);
    }
    /// A normal in its place, of any length: by the inverse transposed, but for that length.
    V3f normal(const V3f& n) const noexcept {
        return {cofactors[0].dot(n), cofactors[1].dot(n), cofactors[2].dot(n)};
    }

    MeshId mesh;
    std::array<V3f, 3> rows;  ///< rows of the linear part
    V3f translation;
    std::array<V3f, 3> cofactors;  ///< cofactors of the rows
    bool is_mirrored;
};

}  // namespace lightcull
