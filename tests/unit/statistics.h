#pragma once

#include <lightcull/float3.h>

#include <cmath>
#include <cstddef>
#include <vector>

/// These comparisons of statistics share one rate of false alarms.

namespace statistics {

/// The rate of false alarms. Were nothing wrong and the random numbers drawn anew, all comparisons
/// of the renderer's tests together would fail once in a thousand times (Sidak's correction). The
/// seeds are fixed: a red test means a change of the code.
inline constexpr double kFalseAlarmRate = 1e-3;
inline constexpr double kMostComparisons = 10000.0;

/// The p-value below which one comparison fails.
inline double least_p() {
    return -std::expm1(std::log1p(-kFalseAlarmRate) / kMostComparisons);
}

/// The two-sided p-value of a standard normal deviate.
inline double p_of_z(double z) {
    return std::erfc(std::fabs(z) / std::sqrt(2.0));
}

/// The probability that chi-square with that many degrees of freedom is larger (Wilson and
/// Hilferty's approximation).
inline double p_of_chi_square(double chi_square, double degrees) {
    const double spread = 2.0 / (9.0 * degrees);
    const double z = (std::cbrt(chi_square / degrees) - (1.0 - spread)) / std::sqrt(spread);
    return 0.5 * std::erfc(z / std::sqrt(2.0));
}

/// The mean of samples, and the variance of that mean.
struct Estimate {
    double mean = 0.0, variance = 0.0;
};

/// Sums samples one by one.
class Accumulator {
  public:
    void add(double x) {
        ++count_;
        const double from_mean = x - mean_;
        mean_ += from_mean / static_cast<double>(count_);
        squares_ += from_mean * (x - mean_);
    }
    Estimate estimate() const {
        const auto n = static_cast<double>(count_);
        return {mean_, squares_ / (n * (n - 1.0))};
    }

  private:
    std::size_t count_ = 0;
    double mean_ = 0.0, squares_ = 0.0;
};

/// The deviate of the difference of two means; 0 where both are without noise and equal.
inline double z_of(const Estimate& a, const Estimate& b) {
    const double difference = a.mean - b.mean;
    return difference == 0.0 ? 0.0 : difference / std::sqrt(a.variance + b.variance);
}

/// The least p-value among pairs of means.
inline double worst_p(const std::vector<Estimate>& a, const std::vector<Estimate>& b) {
    double p = 1.0;
    for (std::size_t i = 0; i < a.size(); ++i) p = std::fmin(p, p_of_z(z_of(a[i], b[i])));
    return p;
}

}  // namespace statistics
