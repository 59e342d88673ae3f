#include "render/instance.h"

namespace lightcull {
namespace {

V3f row_of(const Placement& p, std::size_t k) noexcept {
    return {p.rows[k][0], p.rows[k][1], p.rows[k][2]};
}

}  // namespace

Instance::Instance(MeshId m, const Placement& p) noexcept
    : mesh(m),
      rows{row_of(p, 0), row_of(p, 1), row_of(p, 2)},
      translation(p.rows[0][3], p.rows[1][3], p.rows[2][3]),
      cofactors{rows[1].cross(rows[2]), rows[2].cross(rows[0]), rows[0].cross(rows[1])},
      is_mirrored(rows[0].dot(cofactors[0]) < 0.0f) {
    // What is outside stays outside in a mirror.
    if (is_mirrored) {
        for (V3f& c : cofactors) c = -c;
    }
}

}  // namespace lightcull
