#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require

// The twin of lights/baselines/paper_sampler.cpp, [TH16] Algs. 2 and 3, one selection per
// invocation: a list of the accepted lights in shared memory, kept to k by reservoir sampling, and
// one of them found by a binary search of the CDF of their weights.

#include "records.glsl"

layout(local_size_x = 32) in;

layout(std430, binding = 0) readonly buffer Nodes { SphereNode nodes[]; };
layout(std430, binding = 1) readonly buffer Order { BreadthFirst breadth_first[]; };
layout(std430, binding = 2) readonly buffer Radii { float radii[]; };
layout(std430, binding = 3) readonly buffer Records { LightRecord records[]; };
layout(std430, binding = 4) readonly buffer Lights { uint lights[]; };
layout(std430, binding = 5) readonly buffer Points { ShadingPoint points[]; };
layout(std430, binding = 6) readonly buffer Randoms { float u[]; };
layout(std430, binding = 7) writeonly buffer Selections { Selected selections[]; };

layout(push_constant, std430) uniform Job {
    Float3 origin;
    float inv_scale;
    float reach;
    uint point_count;
    uint node_count;
} job;

layout(constant_id = 2) const uint kListSize = 1;
layout(constant_id = 3) const bool kRangeAtVertex = true;
layout(constant_id = 4) const bool kWeightByG = true;

#include "numbers.glsl"
#include "receiver.glsl"
#include "sphere_tree_walk.glsl"
#include "importance.glsl"

struct Accepted {
    uint record;
    float importance;
    float inverse_prob;
};

// The arrays lightList and cdf, one of each for each invocation.
shared Accepted list[kListSize * gl_WorkGroupSize.x];
shared float cdf[kListSize * gl_WorkGroupSize.x];

uint place_in_list(uint i) {
    return i * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
}

// The number that RandomStream::next() gives for a key.
float next_random(uint64_t key, uint counter) {
    precise float random =
        float(uint(hash(key, uint64_t(counter)) >> 40)) * (1.0 / 16777216.0);
    return random;
}

// Adds the found-th accepted light, as Alg. 3 does.
void add_to_list(Accepted accepted, uint found, uint64_t key) {
    if (found < kListSize) {
        list[place_in_list(found)] = accepted;
        return;
    }
    precise float place = next_random(key, found - kListSize) * float(found + 1);
    if (place < float(kListSize)) list[place_in_list(uint(place))] = accepted;
}

// Fills the list, and returns how many were found.
uint find_accepted(Receiver point, uint set, uint64_t key) {
    uint found = 0;
    const uint first_radius = set * job.node_count * 8;
    start_walk();
    for (uint node; take(node);) {
        for (uint slot = 0; slot < 8; ++slot) {
            if (!concerns(node, slot, radii[first_radius + node * 8 + slot], point)) continue;
            const uint link = nodes[node].link[slot];
            if ((link & kLeaf) == 0) {
                add(link);
                continue;
            }
            const uint record = link & ~kLeaf;
            const LightRecord light = records[record];
            const Way way = way_to(vec(light.center), point);
            const float g = light_importance(light, point, way);
            if (!(g > 0.0)) continue;
            const float inverse_prob =
                inverse_prob_of(light.radius, light.intensity, way.distance2);
            add_to_list(Accepted(record, g, inverse_prob), found, key);
            ++found;
        }
    }
    return found;
}

float weight_of(Accepted accepted) {
    precise float by_p = accepted.importance * accepted.inverse_prob;
    return kWeightByG ? accepted.importance : by_p;
}

// Builds the CDF of the first `size` of the list, and returns their sum.
float build_cdf(uint size) {
    precise float sum = 0.0;
    for (uint j = 0; j < size; ++j) {
        sum += weight_of(list[place_in_list(j)]);
        cdf[place_in_list(j)] = sum;
    }
    return sum;
}

// The first of `size` places, of which there is one at least, at which the CDF rises above the
// target; else the last.
uint search_cdf(uint size, float target) {
    uint begin = 0, end = size - 1;
    while (begin < end) {
        const uint middle = (begin + end) / 2;
        if (cdf[place_in_list(middle)] > target) {
            end = middle;
        } else {
            begin = middle + 1;
        }
    }
    return begin;
}

void main() {
    const uint i = gl_GlobalInvocationID.x;
    if (i >= job.point_count) return;
    const ShadingPoint shading = points[i];
    const Receiver point = receiver_of(shading);
    const uint u_bits = floatBitsToUint(u[i]);
    const uvec3 x_bits = floatBitsToUint(point.position);
    const uint64_t key = hash(hash(uint64_t(u_bits), uint64_t(x_bits.x)), uint64_t(x_bits.y));
    const uint found = find_accepted(point, shading.set, key);
    if (found == 0) {
        selections[i] = Selected(0, 0.0, 0.0, shading.set);
        return;
    }

    const uint size = min(found, kListSize);
    const float sum = build_cdf(size);
    precise float target = u[i] * sum;
    const Accepted chosen = list[place_in_list(search_cdf(size, target))];
    const float weight = weight_of(chosen);
    const float numerator = kRangeAtVertex ? weight : quotient(weight, chosen.inverse_prob);
    const float keep_prob = quotient(float(size), float(found));
    precise float prob = keep_prob * quotient(numerator, sum);
    selections[i] = Selected(lights[chosen.record], prob, sum, shading.set);
}
