#pragma once

#include <mitsuba/core/logger.h>

#include <atomic>
#include <cstddef>

namespace mitsuba::culling {

/// Says, once for each variant, what to do about a scene that has more emitting shapes than LLVM
/// variants cope with.
template <typename Scene>
void warn_of_many_shapes(const Scene* scene) {
    constexpr std::size_t kMany = 500;
    static std::atomic<bool> warned{false};
    std::size_t count = 0, others = 0;
    for (const auto& emitter : scene->emitters()) {
        if (!emitter->shape()) continue;
        ++count;
        others += emitter->shape()->is_mesh() ? 0 : 1;
    }
    if (count <= kMany || warned.exchange(true)) return;
    Log(Warn,
        "The scene has %u shapes that emit. In LLVM variants the time of a render grows with the "
        "square of their number: merge them into one mesh by "
        "lightcull.mitsuba.merge_emitters(scene_dict). It leaves what is no mesh, as %u of them "
        "are: write spheres as meshes of few triangles.",
        count, others);
}

}  // namespace mitsuba::culling
