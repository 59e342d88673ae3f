// The twin of lights/light/receiver.h, with tests of how near something is to a receiver.

struct Receiver {
    vec3 position;
    vec3 normal;
    float from_all_sides;
    float horizon;
    float diffuse;
    vec3 axis;
    float alpha2;
    float peak;
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

struct Way {
    vec3 way;
    float distance2;
    float height;
};

Way way_to(vec3 center, Receiver point) {
    precise vec3 way = center - point.position;
    return Way(way, dot3(way, way), dot3(point.normal, way));
}

const float kHorizonOfNodes = 2.0;

// True if the point is within a slot's sphere, and what the slot holds is not below the horizon.
bool concerns(uint node, uint slot, float radius, Receiver point) {
    const vec3 center = vec3(nodes[node].x[slot], nodes[node].y[slot], nodes[node].z[slot]);
    const Way way = way_to(center, point);
    precise float radius2 = radius * abs(radius);
    precise float top = way.height + nodes[node].bounds[slot];
    precise float horizon = kHorizonOfNodes * point.horizon;
    return way.distance2 <= radius2 && top > horizon;
}

// The inverse 1 / p of [TH16] Eq. 1.
float inverse_prob_of(float radius, float intensity, float distance2) {
    precise float limit = job.reach * intensity;
    precise float inverse_limit = 1.0 / max(limit, 1e-36);
    precise float distance = max(sqrt(distance2) - radius, 0.0);
    precise float inverse_prob = max(distance * distance * inverse_limit, 1.0);
    return inverse_prob;
}
