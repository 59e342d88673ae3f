#include "virtual_lights/tiles/prepared_lights.h"

#include "base/parallel_blocks.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lightcull {
namespace {

constexpr std::size_t kBlock = 4096;

/// The number of classes of ranges. A class is an octave of squares of ranges: an exponent of a
/// float, some of which share a class.
constexpr std::uint32_t kClasses = 256;
std::uint32_t class_of(float range2) noexcept {
    const int octave = std::ilogb(std::max(range2, std::numeric_limits<float>::min()));
    return static_cast<std::uint32_t>(std::clamp(128 - octave, 0, int{kClasses} - 1));
}

}  // namespace

PreparedLights::PreparedLights(const std::vector<VirtualLight>& lights,
                               const Acceptance& acceptance, BoundingVolume volume,
                               const CameraRays& camera, std::uint32_t subsets)
    : trees_(subsets) {
    order(lights, acceptance, subsets);
    if (!acceptance.has_ranges()) return;
    volumes_.resize(lights.size());
    boxes_.resize(lights.size());
    for_each_block(lights.size(), kBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Spheroid spheroid = acceptance.volume(lights_[i], of_light_[i], volume);
            volumes_[i] = VolumeInView(spheroid, camera);
            boxes_[i] = box_in_view(spheroid, camera);
        }
    });
    for (std::uint32_t s = 0; s < subsets; ++s) {
        trees_[s] = BoxTree({boxes_.data() + begins_[s], begins_[s + 1] - begins_[s]});
    }
}

/// Counts the lights of each class of each subset, and puts them there.
void PreparedLights::order(const std::vector<VirtualLight>& lights, const Acceptance& acceptance,
                           std::uint32_t subsets) {
    const std::size_t size = lights.size();
    std::vector<Acceptance::OfLight> of_light(size);
    std::vector<float> farthest2(size);
    std::vector<std::uint32_t> places(size);  // at first, the lights' classes
    for_each_block(size, kBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            of_light[i] = acceptance.of_light(lights[i], static_cast<std::uint32_t>(i));
            farthest2[i] = acceptance.farthest2(lights[i], of_light[i]);
            places[i] = static_cast<std::uint32_t>(i % subsets) * kClasses + class_of(farthest2[i]);
        }
    });
    std::vector<std::uint32_t> next(std::size_t{subsets} * kClasses + 1, 0);
    for (const std::uint32_t c : places) ++next[c + 1];
    for (std::size_t c = 1; c < next.size(); ++c) next[c] += next[c - 1];
    for (std::uint32_t s = 0; s <= subsets; ++s) begins_.push_back(next[std::size_t{s} * kClasses]);
    for (std::uint32_t& place : places) place = next[place]++;

    lights_.resize(size);
    of_light_.resize(size);
    farthest2_.resize(size);
    for_each_block(size, kBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            lights_[places[i]] = lights[i];
            of_light_[places[i]] = of_light[i];
            farthest2_[places[i]] = farthest2[i];
        }
    });
}

void PreparedLights::List::add(const Listed& light) {
    x.push_back(light.position.x);
    y.push_back(light.position.y);
    z.push_back(light.position.z);
    farthest2.push_back(light.farthest2);
    index.push_back(light.index);
}

PreparedLights::List PreparedLights::list(std::uint32_t subset, const FrustumPiece& piece) const {
    List list;
    if (piece.empty) return list;
    if (volumes_.empty()) {
        for (std::size_t i = begin(subset); i < begin(subset + 1); ++i) list.add(listed(i));
        return list;
    }
    trees_[subset].for_overlapping(piece.box(), [&](std::uint32_t k) {
        const std::size_t i = begin(subset) + k;
        if (volumes_[i].overlaps(piece)) list.add(listed(i));
    });
    return list;
}

}  // namespace lightcull
