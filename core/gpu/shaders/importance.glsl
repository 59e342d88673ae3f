// The twin of lights/light/importance.h.

struct Angle {
    float sine, cosine;
};

float other_of(float sine_or_cosine) {
    precise float square = 1.0 - sine_or_cosine * sine_or_cosine;
    return root(max(square, 0.0));
}

Angle subtract_clamped(Angle a, Angle b) {
    if (a.cosine >= b.cosine) return Angle(0.0, 1.0);
    precise float sine = a.sine * b.cosine - a.cosine * b.sine;
    precise float cosine = a.cosine * b.cosine + a.sine * b.sine;
    return Angle(sine, cosine);
}

// A 16-bit integer of a record, in its low or high half, by LightRecord::kSnorm.
float snorm(uint word, int offset) {
    precise float value = float(bitfieldExtract(int(word), offset, 16)) * (1.0 / 32767.0);
    return value;
}

bool is_two_sided(LightRecord light) {
    return (light.cos_theta_e_two_sided >> 16) != 0;
}

vec3 axis_of(LightRecord light) {
    return vec3(snorm(light.axis_xy, 0), snorm(light.axis_xy, 16),
                snorm(light.axis_z_cos_theta_o, 0));
}

// The largest cosine of the emission of a light whose bounding sphere the point is outside of.
float emitter_bound(LightRecord light, vec3 way, float distance) {
    precise vec3 direction = way * quotient(1.0, distance);
    float cos_theta = clamp(-dot3(axis_of(light), direction), -1.0, 1.0);
    if (is_two_sided(light)) cos_theta = abs(cos_theta);
    const float cos_theta_o = snorm(light.axis_z_cos_theta_o, 16);
    const float half_sine = quotient(light.radius, distance);
    const Angle from_normal = subtract_clamped(Angle(other_of(cos_theta), cos_theta),
                                               Angle(other_of(cos_theta_o), cos_theta_o));
    const float cosine =
        subtract_clamped(from_normal, Angle(half_sine, other_of(half_sine))).cosine;
    return cosine > snorm(light.cos_theta_e_two_sided, 0) ? cosine : 0.0;
}

const float kMinDistance2 = 1e-30;

float light_importance(LightRecord light, Receiver point, Way way) {
    precise float spread = 0.25 * light.radius * light.radius;
    precise float mean_distance2 = way.distance2 + spread;
    if (!(mean_distance2 > kMinDistance2)) return 0.0;
    const float inverse = quotient(1.0, root(mean_distance2));

    float received = 1.0;
    if (point.normal != vec3(0)) {
        precise float top = way.height + light.radius;
        if (top <= 0.0) return 0.0;
        precise float square = way.height * way.height + 0.375 * spread;
        precise float above = 0.5 * (way.height + root(square)) * inverse;
        received = above;
    }
    if (point.peak > 0.0) {
        precise float cosine = dot3(point.axis, way.way) * inverse;
        precise float width = point.alpha2 + 0.25 * (spread * inverse * inverse);
        precise float off_axis = width + 0.5 * (1.0 - cosine);
        const float inverse_width = quotient(1.0, off_axis);
        precise float both = point.diffuse * received +
                             point.peak * point.alpha2 * width * inverse_width * inverse_width;
        received = both;
    }

    float emitter = 1.0;
    const float distance = root(way.distance2);
    if (bitfieldExtract(int(light.axis_z_cos_theta_o), 16, 16) == 32767) {
        float height = -dot3(axis_of(light), way.way);
        if (is_two_sided(light)) height = abs(height);
        precise float cosine = height * inverse + 5e-5;
        emitter = min(cosine, 1.0);
    } else if (distance > light.radius) {
        emitter = emitter_bound(light, way.way, distance);
    }
    if (!(emitter > 0.0)) return 0.0;
    precise float g = light.intensity * inverse * inverse * received * emitter;
    return g;
}
