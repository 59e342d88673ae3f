#include "gpu/chooser.h"

#include "gpu/shaders.h"

namespace lightcull {
namespace {

template <typename T>
Span<const std::byte> bytes_of(const std::vector<T>& elements) {
    return {reinterpret_cast<const std::byte*>(elements.data()), elements.size() * sizeof(T)};
}

}  // namespace

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
