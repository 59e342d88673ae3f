// The twin of lights/bvh/light_bvh_descend-inl.h: the way down the light BVH from a node to a
// light, in double precision.

struct Descent {
    uint child;
    double place;
    double prob;
};

LightGroup child_of(uint node, uint slot) {
    LightGroup cluster;
    cluster.center = Float3(bvh[node].center[0][slot], bvh[node].center[1][slot],
                            bvh[node].center[2][slot]);
    cluster.radius = bvh[node].radius[slot];
    cluster.spread = bvh[node].spread[slot];
    cluster.intensity = bvh[node].intensity[slot];
    cluster.axis =
        Float3(bvh[node].axis[0][slot], bvh[node].axis[1][slot], bvh[node].axis[2][slot]);
    cluster.apex = bvh[node].apex[slot];
    cluster.cosine = bvh[node].cosine[slot];
    cluster.mean_normal = Float3(bvh[node].mean_normal[0][slot], bvh[node].mean_normal[1][slot],
                                 bvh[node].mean_normal[2][slot]);
    cluster.diffuse = bvh[node].diffuse[slot];
    cluster.child = bvh[node].child[slot];
    return cluster;
}

const double kBelowOne = 1.0lf - 1.0lf / 9007199254740992.0lf;

// Takes a descent one level down; prob becomes 0 if nothing there reaches the point.
void step_down(Receiver point, inout Descent descent) {
    float g[8];
    double before[8];
    precise double total = 0.0lf;
    for (uint slot = 0; slot < 8; ++slot) {
        const LightGroup cluster = child_of(descent.child, slot);
        g[slot] = importance(cluster, point, way_to(vec(cluster.center), point));
        before[slot] = total;
        total += double(g[slot]);
    }
    if (!(total > 0.0lf)) {
        descent.prob = 0.0lf;
        return;
    }
    precise double target = descent.place * total;
    uint chosen = 0;
    for (uint slot = 1; slot < 8; ++slot) chosen += before[slot] <= target ? 1 : 0;
    precise double within = (target - before[chosen]) / double(g[chosen]);
    precise double prob = descent.prob * (double(g[chosen]) / total);
    descent = Descent(bvh[descent.child].child[chosen], min(within, kBelowOne), prob);
}

void descend(Receiver point, inout Descent descent) {
    while ((descent.child & kLight) == 0 && descent.prob > 0.0lf) step_down(point, descent);
}
