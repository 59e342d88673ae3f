#pragma once

#include <algorithm>
#include <cmath>

/// Angles without the C library, whose functions take longer, and differ in their last bits from
/// one processor to the next. Errors are below half a unit of floats.

namespace lightcull {

template <typename T>
struct SineCosine {
    T sine, cosine;

    /// Those of twice the angle.
    SineCosine doubled() const noexcept {
        return {T{2} * sine * cosine, T{1} - T{2} * sine * sine};
    }
};

/// The sine and cosine of an angle of at most pi / 4, by their series.
template <typename T>
SineCosine<T> sine_cosine(T angle) noexcept {
    constexpr T kSine[] = {T{-1} / 6, T{1} / 120, T{-1} / 5040, T{1} / 362880};
    constexpr T kCosine[] = {T{-1} / 2, T{1} / 24, T{-1} / 720, T{1} / 40320, T{-1} / 3628800};
    const T z = angle * angle;
    const T s = kSine[0] + z * (kSine[1] + z * (kSine[2] + z * kSine[3]));
    const T c =
        kCosine[0] + z * (kCosine[1] + z * (kCosine[2] + z * (kCosine[3] + z * kCosine[4])));
    return {angle + angle * (z * s), T{1} + z * c};
}

/// The angle of (x, y) to (1, 0), within [-pi, pi]; 0 for (0, 0). Relative to the angle it is right
/// to 1e-9.
inline double arc_tangent(double y, double x) noexcept {
    constexpr double kPiDouble = 3.14159265358979323846;
    const double across = std::fabs(y), along = std::fabs(x);
    const double low = std::min(across, along), high = std::max(across, along);
    if (!(high > 0.0)) return 0.0;
    // Half of an angle of at most pi / 4 has a tangent of at most sqrt(2) - 1, for which this
    // polynomial interpolates atan(t) / t at the Chebyshev points of t^2.
    const double t = low / (high + std::sqrt(high * high + low * low)), z = t * t;
    const double ratio =
        0.999999999371 +
        z * (-0.33333306893 +
             z * (0.199981830411 +
                  z * (-0.142395326692 + z * (0.10569828802 + z * -0.0602630521344))));
    double angle = 2.0 * t * ratio;
    if (across > along) angle = 0.5 * kPiDouble - angle;
    if (x < 0.0) angle = kPiDouble - angle;
    return std::copysign(angle, y);
}

}  // namespace lightcull
