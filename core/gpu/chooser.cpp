#include "gpu/chooser.h"

#include "gpu/bytes.h"
#include "gpu/shaders.h"

namespace lightcull {

Chooser chooser_of(const CulledScene& scene) {
    return {shaders::select(), shaders::kSelectWorkgroup, 0, bytes_of(scene.groups.groups),
            bytes_of(scene.groups.bvh.nodes)};
}

Chooser chooser_of(const PaperScene& scene) {
    return {shaders::paper(),
            shaders::kPaperWorkgroup,
            shaders::kPaperWorkgroup * scene.list_size * shaders::kListEntrySize,
            bytes_of(scene.tree.records()),
            bytes_of(scene.tree.lights()),
            {scene.list_size, scene.range_at_vertex, scene.weight_by_g}};
}

}  // namespace lightcull
