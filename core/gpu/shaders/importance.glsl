// The twin of lights/light/importance.h.

struct Angle {
    float sine, cosine;
};

float other_of(float sine_or_cosine) {
    precise float square = 1.0 - sine_or_cosine * sine_or_cosine;
    return root(max(square, 0.0));
}

Angle angle_of_half_sine(float half_sine) {
    const float twice = half_sine + half_sine;
    precise float sine = twice * other_of(half_sine);
    precise float cosine = 1.0 - twice * half_sine;
    return Angle(sine, cosine);
}

Angle subtract_clamped(Angle a, Angle b) {
    precise float sine = a.sine * b.cosine - a.cosine * b.sine;
    if (!(sine > 0.0)) return Angle(0.0, 1.0);
    precise float cosine = a.cosine * b.cosine + a.sine * b.sine;
    return Angle(sine, cosine);
}

// A 16-bit integer of a record, in its low or high half.
int half_word(uint word, int offset) {
    return bitfieldExtract(int(word), offset, 16);
}

const float kSnorm = 1.0 / 32767.0;

bool is_two_sided(LightRecord light) {
    return (light.sin_theta_e_two_sided >> 16) != 0;
}

vec3 snorm_axis_of(LightRecord light) {
    return vec3(half_word(light.axis_xy, 0), half_word(light.axis_xy, 16),
                half_word(light.axis_z_half_sine_o, 0));
}

vec3 cross3(vec3 a, vec3 b) {
    precise float x = a.y * b.z - a.z * b.y;
    precise float y = a.z * b.x - a.x * b.z;
    precise float z = a.x * b.y - a.y * b.x;
    return vec3(x, y, z);
}

const float kAxisRounding = 5e-5;

// The largest cosine with which anything in a light's cone of normals may emit towards a point that
// is outside of its bounding sphere; not above 0 where nothing can.
float emitter_bound(LightRecord light, vec3 way, float distance) {
    const float inverse = quotient(1.0, distance);
    precise vec3 axis = snorm_axis_of(light) * kSnorm;
    const vec3 across = cross3(axis, way);
    precise float cosine = -dot3(axis, way) * inverse;
    if (is_two_sided(light)) cosine = abs(cosine);
    precise float sine = root(dot3(across, across)) * inverse;
    precise float half_sine = float(half_word(light.axis_z_half_sine_o, 16)) * kSnorm;
    Angle from_normal = subtract_clamped(Angle(sine, cosine), angle_of_half_sine(half_sine));
    if (light.radius > 0.0) {
        precise float half_view = light.radius * inverse;
        from_normal = subtract_clamped(from_normal, Angle(half_view, other_of(half_view)));
    }
    precise float largest = float(half_word(light.sin_theta_e_two_sided, 0)) * 3.05201e-5;
    return from_normal.sine <= largest ? from_normal.cosine : 0.0;
}

const float kMinDistance2 = 1e-30;

const float kLeastTwiceHalf2 = 1e-20;

float mean_of_lobe(Receiver point, vec3 direction, float angular_spread) {
    precise vec3 from_axis = direction - point.axis;
    const float above = dot3(point.normal, from_axis);
    precise vec3 across = from_axis - point.normal * above;
    const float across2 = dot3(across, across);
    precise float along = dot3(point.normal, direction) + dot3(point.normal, point.axis);
    precise float twice_half2 =
        along * along + point.from_all_sides + max(across2, kLeastTwiceHalf2);
    const float inverse_half2 = quotient(1.0, twice_half2);
    precise float width = point.alpha2 + (0.125 + 0.5 * inverse_half2) * angular_spread;
    precise float blurred = width + (1.0 - point.alpha2) * (across2 * inverse_half2);
    const float inverse = quotient(1.0, blurred);
    precise float lobe = point.peak * point.alpha2 * width * inverse * inverse;
    return lobe;
}

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
        precise vec3 direction = way.way * inverse;
        precise float angular_spread = spread * inverse * inverse;
        precise float both =
            point.diffuse * received + mean_of_lobe(point, direction, angular_spread);
        received = both;
    }

    float emitter = 1.0;
    const float distance = root(way.distance2);
    const int half_sine_o = half_word(light.axis_z_half_sine_o, 16);
    if (half_sine_o == 0) {
        precise float height = -dot3(snorm_axis_of(light), way.way) * kSnorm;
        if (is_two_sided(light)) height = abs(height);
        precise float cosine = height * inverse + kAxisRounding;
        emitter = min(cosine, 1.0);
    } else if (distance > light.radius && half_sine_o != 32767) {
        emitter = emitter_bound(light, way.way, distance);
    }
    if (!(emitter > 0.0)) return 0.0;
    precise float g = light.intensity * inverse * inverse * received * emitter;
    return g;
}
