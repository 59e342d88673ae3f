#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require

// Makes one selection per invocation: weighs the accepted groups, keeps one, and finds its light.

#include "records.glsl"

layout(local_size_x = 64) in;

layout(std430, binding = 0) readonly buffer Nodes { SphereNode nodes[]; };
layout(std430, binding = 1) readonly buffer Order { BreadthFirst breadth_first[]; };
layout(std430, binding = 2) readonly buffer Radii { float radii[]; };
layout(std430, binding = 3) readonly buffer Groups { LightGroup groups[]; };
layout(std430, binding = 4) readonly buffer Bvh { MeansNode bvh[]; };
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

#include "numbers.glsl"
#include "receiver.glsl"
#include "cluster_importance.glsl"
#include "sphere_tree_walk.glsl"
#include "light_bvh_descend.glsl"

// The state of a Reservoir of groups.
struct Choice {
    float weight_sum;
    float numerator;
    uint record;
    uint accepted;  // number of groups so far
};

// The random number of Reservoir::add().
float random_number(uint u_bits, uint record) {
    precise float random =
        to_float(scramble(u_bits ^ (record * 0x9e3779b9u))) * (1.0 / 4294967296.0);
    return min(random, 1.0 - 1.0 / 8388608.0);
}

void weigh(uint record, Receiver point, uint u_bits, inout Choice choice) {
    const LightGroup group = groups[record];
    const Way way = way_to(vec(group.center), point);
    const float g = importance(group, point, way);
    if (!(g > 0.0)) return;
    const float inverse_prob = inverse_prob_of(group.radius, group.intensity, way.distance2);
    precise float weight = g * inverse_prob;
    precise float sum = choice.weight_sum + weight;
    choice.weight_sum = sum;
    ++choice.accepted;
    precise float place = random_number(u_bits, record) * sum;
    if (!(place < weight)) return;
    choice.numerator = g;
    choice.record = record;
}

Choice choose_group(Receiver point, uint set, uint u_bits) {
    Choice choice = Choice(0.0, 0.0, 0, 0);
    const uint first_radius = set * job.node_count * 8;
    start_walk();
    for (uint node; take(node);) {
        for (uint slot = 0; slot < 8; ++slot) {
            if (!concerns(node, slot, radii[first_radius + node * 8 + slot], point)) continue;
            const uint link = nodes[node].link[slot];
            if ((link & kLeaf) != 0) {
                weigh(link & ~kLeaf, point, u_bits, choice);
            } else {
                add(link);
            }
        }
    }
    return choice;
}

// A descent at the top of the group that was chosen, or of all if none was.
Descent start_descent(Choice choice, uint u_bits) {
    const bool none = !(choice.weight_sum > 0.0);
    const double place =
        uniform_double(hash(uint64_t(u_bits), uint64_t(none ? kNoGroup : choice.record)));
    if (none) return Descent(0, place, 1.0lf);
    precise float prob = choice.numerator / choice.weight_sum;
    return Descent(groups[choice.record].child, place, double(prob));
}

void main() {
    const uint i = gl_GlobalInvocationID.x;
    if (i >= job.point_count) return;
    const ShadingPoint shading = points[i];
    const Receiver point = receiver_of(shading);
    const uint u_bits = floatBitsToUint(u[i]);
    const Choice choice = choose_group(point, shading.set, u_bits);
    Descent descent = start_descent(choice, u_bits);
    descend(point, descent);

    const bool alone = choice.accepted == 1 && choice.numerator < choice.weight_sum;
    const float sum = alone ? -choice.weight_sum : choice.weight_sum;
    const bool found = descent.prob > 0.0lf;
    selections[i] = Selected(found ? descent.child & ~kLight : 0, float(descent.prob), sum,
                              shading.set);
}
