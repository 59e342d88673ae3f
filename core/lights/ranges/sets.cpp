#include <lightcull/sets.h>

#include <algorithm>

#include "base/random.h"
#include "lights/ranges/pattern.h"

namespace lightcull {
namespace {

/// The digits to the base of 2 in reverse order: the numbers below 2^digits, any first few of them
/// spread evenly.
std::uint32_t reverse_bits(std::uint32_t number, std::uint32_t digits) noexcept {
    std::uint32_t reversed = 0;
    for (std::uint32_t bit = 0; bit < digits; ++bit) {
        reversed |= ((number >> bit) & 1u) << (digits - 1 - bit);
    }
    return reversed;
}

/// The logarithm to the base of 2 of the edge of the squares of pixels that are dithered, whose
/// places hold evenly spread rotations of one draw.
std::uint32_t log2_square(const SetPattern& pattern) noexcept {
    return std::min(pattern.log2_edge(), 2u);
}

}  // namespace

std::uint32_t set_of_pixel(std::uint32_t x, std::uint32_t y, std::uint64_t pass,
                           std::uint32_t set_count) noexcept {
    const SetPattern pattern(set_count);
    const std::uint32_t edge = log2_square(pattern);
    const std::uint64_t key = mix(pass);
    // The squares lie elsewhere in each pass: across their borders neighbours may share a set.
    x += static_cast<std::uint32_t>(key) & 3u;
    y += static_cast<std::uint32_t>(key >> 2) & 3u;
    const std::uint64_t square = hash(key, (std::uint64_t{y >> edge} << 32) | (x >> edge));
    const auto draw = static_cast<std::uint32_t>(square) & (pattern.draws() - 1);
    const auto first_rank = static_cast<std::uint32_t>(square >> 32);
    return pattern.set_of((first_rank + pattern.rank_at(x, y)) & (pattern.rotations() - 1), draw);
}

std::uint32_t set_of_packet(std::uint32_t packet, std::uint32_t set_count) noexcept {
    // The sets of later bounces are few, but spread over all rotations.
    constexpr std::uint32_t kSetsOfBounces = 16;
    const SetPattern pattern(set_count);
    const std::uint32_t used = std::min(pattern.rotations(), kSetsOfBounces);
    const SetPattern few(used);
    const std::uint32_t rank_among_used = few.rank_of(packet % used);
    return pattern.set_of(rank_among_used * (pattern.rotations() / used), 0);
}

std::uint32_t set_of_sample(std::uint32_t x, std::uint32_t y, std::uint32_t sample,
                            std::uint32_t bounce, std::uint32_t set_count) noexcept {
    const SetPattern pattern(set_count);
    // Only the points that the camera sees are dithered: later on there are no neighbours.
    const std::uint32_t edge = bounce == 0 ? log2_square(pattern) : 0;
    const std::uint64_t place =
        hash((std::uint64_t{y >> edge} << 32) | (x >> edge), std::uint64_t{bounce});
    const auto first_draw = static_cast<std::uint32_t>(place);
    const auto first_rank = static_cast<std::uint32_t>(place >> 32);
    // A pixel goes through all rotations of a draw, the farthest first, before it takes the next
    // draw: they stratify the numbers of each light, which leaves a quarter less error than as many
    // independent draws. The image is even all the same, since other squares take other draws.
    const std::uint32_t draw = (sample / pattern.rotations() + first_draw) & (pattern.draws() - 1);
    const std::uint32_t turn =
        reverse_bits(sample & (pattern.rotations() - 1), 2 * pattern.log2_edge());
    const std::uint32_t dither = bounce == 0 ? pattern.rank_at(x, y) : 0;
    const std::uint32_t rank = (first_rank + dither + turn) & (pattern.rotations() - 1);
    return pattern.set_of(rank, draw);
}

}  // namespace lightcull
