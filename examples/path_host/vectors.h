#pragma once

// Arithmetic of vectors and colours, and random numbers. Nothing here knows of light sampling.

#include <lightcull/float3.h>

#include <cmath>
#include <cstdint>

namespace host {

using lightcull::float3;

inline constexpr float kPi = 3.14159265f;

inline float3 operator+(float3 a, float3 b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline float3 operator-(float3 a, float3 b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline float3 operator*(float3 a, float3 b) {
    return {a.x * b.x, a.y * b.y, a.z * b.z};
}
inline float3 operator*(float s, float3 a) {
    return {s * a.x, s * a.y, s * a.z};
}
inline float dot(float3 a, float3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline float3 cross(float3 a, float3 b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline float3 normalize(float3 a) {
    return (1.0f / std::sqrt(dot(a, a))) * a;
}
inline float luminance(float3 rgb) {
    return dot(rgb, {0.2126f, 0.7152f, 0.0722f});
}

/// Two axes that, with a unit vector as the third, are at right angles to one another (Duff et al.
/// 2017).
struct Frame {
    float3 x, y, z;

    explicit Frame(float3 axis) : z(axis) {
        const float sign = std::copysign(1.0f, axis.z);
        const float a = -1.0f / (sign + axis.z), b = axis.x * axis.y * a;
        x = {1.0f + sign * axis.x * axis.x * a, sign * b, -sign * axis.x};
        y = {b, sign + axis.y * axis.y * a, -axis.y};
    }
    float3 to_world(float3 v) const { return v.x * x + v.y * y + v.z * z; }
    float3 to_local(float3 v) const { return {dot(v, x), dot(v, y), dot(v, z)}; }
};

/// The finaliser of splitmix64.
inline std::uint64_t mix(std::uint64_t bits) {
    bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9u;
    bits = (bits ^ (bits >> 27)) * 0x94d049bb133111ebu;
    return bits ^ (bits >> 31);
}

/// splitmix64: small enough for each path to have one of its own.
class Random {
  public:
    explicit Random(std::uint64_t seed = 0) : state_(mix(seed)) {}

    /// A number in [0, 1).
    float uniform() {
        state_ += 0x9e3779b97f4a7c15u;
        return static_cast<float>(mix(state_) >> 40) * 0x1p-24f;
    }

  private:
    std::uint64_t state_;
};

/// A direction about z with a density of cosine / pi.
inline float3 cosine_direction(Random& random) {
    const float radius2 = random.uniform(), angle = 2.0f * kPi * random.uniform();
    const float radius = std::sqrt(radius2);
    return {radius * std::cos(angle), radius * std::sin(angle), std::sqrt(1.0f - radius2)};
}

}  // namespace host
