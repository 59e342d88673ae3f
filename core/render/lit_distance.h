#pragma once

#include "render/emitter.h"
#include "render/scene_data.h"

namespace lightcull {

/// The distance from an emissive triangle to what it lights, metres: most of what takes its light
/// is not nearer. Infinity if it lights nothing. Of the two sides of one that emits on both, it is
/// the smaller one. By a few rays, which are always the same.
float lit_distance(const SceneData& scene, const TriangleEmitter& emitter);

}  // namespace lightcull
