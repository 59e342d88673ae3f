#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require

// One selection per invocation: weighs the accepted groups, keeps one, and finds its light.

#include "records.glsl"

layout(local_size_x = 64) in;

layout(std430, binding = 0) readonly buffer Nodes { SphereNode nodes[]; };
layout(std430, binding = 1) readonly buffer Order { BreadthFirst breadth_first[]; };
layout(std430, binding = 2) readonly buffer Radii { float radii[]; };
layout(std430, binding = 3) readonly buffer Groups { LightGroup groups[]; };
layout(std430, binding = 4) readonly buffer Bvh { MeansNode bvh[]; };
layout(std430, binding = 5) readonly buffer Points { ShadingPoint points[]; };
layout(std430, binding = 6) readonly buffer Randoms { float u[]; };
layout(std430, binding = 7) writeonly buffer Selections { Selection selections[]; };

layout(push_constant, std430) uniform Job {
    Float3 origin;
    float inv_scale;
    float reach;
    uint point_count;
    uint node_count;
} job;

#include "numbers.glsl"
#include "importance.glsl"
#include "walk.glsl"
#include "descend.glsl"

const float kHorizonOfNodes = 2.0;

// What a Reservoir of groups holds.
struct Choice {
    float weight_sum;
    float numerator;
    uint record;
    uint accepted;  // groups so far
};

Receiver receiver_of(ShadingPoint point) {
    precise vec3 x = (vec(point.position) - vec(job.origin)) * job.inv_scale;
    precise float rounding = 1e-6 * (1.0 + abs(x.x) + abs(x.y) + abs(x.z));
    const vec3 normal = vec(point.normal);
    const bool volume = normal == vec3(0);
    precise float alpha2 = point.lobe_alpha * point.lobe_alpha;
    return Receiver(x, normal, volume ? 4.0 : 0.0, volume ? -1e30 : -rounding, point.diffuse,
                    vec(point.lobe_axis), alpha2, point.lobe_peak);
}

// Whether the point is within a slot's sphere, and what it holds is not below the horizon.
bool concerns(uint node, uint slot, float radius, Receiver point) {
    const vec3 center = vec3(nodes[node].x[slot], nodes[node].y[slot], nodes[node].z[slot]);
    const Way way = way_to(center, point);
    precise float radius2 = radius * abs(radius);
    precise float top = way.height + nodes[node].bounds[slot];
    precise float horizon = kHorizonOfNodes * point.horizon;
    return way.distance2 <= radius2 && top > horizon;
}

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
    precise float limit = job.reach * group.intensity;
    precise float inverse_limit = 1.0 / max(limit, 1e-36);
    precise float distance = max(sqrt(way.distance2) - group.radius, 0.0);
    precise float inverse_prob = max(distance * distance * inverse_limit, 1.0);
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

// At the top of the group that was chosen, or of all if none was.
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
    selections[i] = Selection(found ? descent.child & ~kLight : 0, float(descent.prob), sum,
                              shading.set);
}
