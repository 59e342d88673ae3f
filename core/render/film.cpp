#include "render/film.h"

namespace lightcull {

void Film::add(const std::vector<V3f>& pass) {
    for (std::size_t i = 0; i < sums_.size(); ++i) sums_[i] += Imath::V3d(pass[i]);
    ++passes_;
}

std::vector<float3> Film::mean() const {
    std::vector<float3> image(sums_.size());
    if (passes_ == 0) return image;
    const double scale = 1.0 / static_cast<double>(passes_);
    for (std::size_t i = 0; i < sums_.size(); ++i) image[i] = to_float3(V3f(sums_[i] * scale));
    return image;
}

std::vector<float3> Film::mean_without(const Film& part) const {
    Film rest = *this;
    for (std::size_t i = 0; i < sums_.size(); ++i) rest.sums_[i] -= part.sums_[i];
    return rest.mean();
}

void Film::restore(Span<const double> sums, std::uint64_t passes) noexcept {
    for (std::size_t i = 0; i < sums_.size(); ++i) {
        sums_[i] = Imath::V3d(sums[3 * i], sums[3 * i + 1], sums[3 * i + 2]);
    }
    passes_ = passes;
}

}  // namespace lightcull
