#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require

// The twin of lights/ranges/sphere_tree_refit-inl.h: all radii of a set, bottom-up. There is a
// workgroup per set, and an invocation per node of a level.

#include "records.glsl"

layout(local_size_x = 64) in;

layout(std430, binding = 0) readonly buffer Nodes { SphereNode nodes[]; };
layout(std430, binding = 1) readonly buffer Order { BreadthFirst breadth_first[]; };
layout(std430, binding = 2) writeonly buffer Radii { float radii[]; };
layout(std430, binding = 3) readonly buffer Centers { Float3 centers[]; };
layout(std430, binding = 4) readonly buffer Records { RangedLight records[]; };
layout(std430, binding = 5) readonly buffer Levels { uint levels[]; };
layout(std430, binding = 6) readonly buffer Turns { Turn turns[]; };
layout(std430, binding = 7) coherent buffer Around { float around[]; };

layout(push_constant, std430) uniform Job {
    float reach;
    uint key_low, key_high;
    uint node_count;
    uint level_count;
} job;

#include "numbers.glsl"

// The number RandomRanges::xi() of a light in a set.
float xi(uint record, Turn turn) {
    const uint high = scramble(scramble(record ^ job.key_low) + job.key_high + turn.draw);
    precise float low = float(scramble(high + job.key_low) >> 8) + 1.0;
    precise float turned =
        (to_float(high + turn.rank) + low * (1.0 / 16777216.0)) * (1.0 / 4294967296.0);
    return turned;
}

float leaf_radius(uint record, Turn turn) {
    const RangedLight light = records[record];
    precise float limit = job.reach * light.intensity;
    const float range = root(quotient(max(limit, 1e-36), xi(record, turn)));
    precise float radius = range + light.radius;
    return radius;
}

void refit_node(uint node, uint set) {
    const uint first = set * job.node_count;
    const vec3 center = vec(centers[node]);
    float largest = 0.0;
    for (uint slot = 0; slot < 8; ++slot) {
        const uint link = nodes[node].link[slot], place = (first + node) * 8 + slot;
        if (link == kEmpty) {
            radii[place] = -1.0;
            continue;
        }
        const float own = (link & kLeaf) != 0 ? leaf_radius(link & ~kLeaf, turns[set])
                                              : around[first + link];
        radii[place] = own;
        precise vec3 offset =
            vec3(nodes[node].x[slot], nodes[node].y[slot], nodes[node].z[slot]) - center;
        precise float reaches = (own + root(dot3(offset, offset))) * (1.0 + 1e-6);
        largest = max(largest, reaches);
    }
    around[first + node] = largest;
}

void main() {
    const uint set = gl_WorkGroupID.x;
    for (uint level = job.level_count; level-- > 0;) {
        for (uint i = levels[level] + gl_LocalInvocationID.x; i < levels[level + 1];
             i += gl_WorkGroupSize.x) {
            refit_node(breadth_first[i].node, set);
        }
        memoryBarrierBuffer();
        barrier();
    }
}
