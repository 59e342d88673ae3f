// The twin of lights/bvh/cluster_importance-inl.h for one cluster and one point.

// The sign -1 for a cluster of which all is two-sided, else 1.
float two_sided(LightGroup cluster) {
    return uintBitsToFloat((floatBitsToUint(cluster.diffuse) & 0x80000000u) | 0x3f800000u);
}

float against(vec3 vector, vec3 way, float two_sided) {
    const float c = dot3(vector, way);
    precise float other = two_sided * c;
    return max(-c, -other);
}

bool may_reach(LightGroup cluster, Receiver point, Way way) {
    const float along = against(vec(cluster.axis), way.way, two_sided(cluster));
    precise float from_apex = along + cluster.apex;
    precise float from_apex2 = way.distance2 + cluster.apex * (along + from_apex);
    precise float squared = from_apex * abs(from_apex), least = cluster.cosine * from_apex2;
    precise float top = way.height + cluster.radius;
    return squared >= least && top > point.horizon;
}

// The sum c + sqrt(c * c + q), negative where q is 0 and c * c underflows.
float softened(float c, float q) {
    precise float sum = c + sqrt(c * c + q);
    return sum;
}

const float kLeastTwiceHalf2 = 1e-20;

float with_lobe(Receiver point, Way way, float inverse_distance, float angular_spread,
                float received) {
    precise vec3 from_axis = way.way * inverse_distance - point.axis;
    const float above = dot3(point.normal, from_axis);
    precise vec3 across = from_axis - above * point.normal;
    const float across2 = dot3(across, across);
    precise float along = way.height * inverse_distance + dot3(point.normal, point.axis);
    precise float twice_half2 =
        along * along + point.from_all_sides + max(across2, kLeastTwiceHalf2);
    precise float inverse_half2 = 1.0 / twice_half2;
    precise float width = point.alpha2 + (0.125 + 0.5 * inverse_half2) * angular_spread;
    precise float inverse = 1.0 / (width + (1.0 - point.alpha2) * (across2 * inverse_half2));
    precise float lobe = point.peak * point.alpha2 * width * inverse * inverse;
    precise float both = point.diffuse * received + lobe;
    return both;
}

const float kMinDistance2 = 1e-30;

// The importance of a cluster, 0 where none of it reaches the point.
float importance(LightGroup cluster, Receiver point, Way way) {
    if (!may_reach(cluster, point, way)) return 0.0;
    const float spread = abs(cluster.spread);
    precise float mean_distance2 = way.distance2 + spread;
    if (!(mean_distance2 > kMinDistance2)) return 0.0;
    precise float from_behind = spread + point.from_all_sides * mean_distance2;
    float received = softened(way.height, from_behind);
    if (point.peak > 0.0) {
        const float root = sqrt(mean_distance2);
        precise float inverse_root = 1.0 / root;
        precise float angular_spread = spread * inverse_root * inverse_root;
        precise float mean_cosine = 0.5 * received * inverse_root;
        precise float both =
            (root + root) * with_lobe(point, way, inverse_root, angular_spread, mean_cosine);
        received = both;
    }
    const float facing = against(vec(cluster.mean_normal), way.way, two_sided(cluster));
    precise float across = max(cluster.spread, 0.0) + abs(cluster.diffuse) * mean_distance2;
    const float emitted = softened(facing, across);
    precise float inverse = 1.0 / mean_distance2;
    precise float g = cluster.intensity * (received * inverse) * (emitted * inverse);
    return max(g, 0.0);
}
