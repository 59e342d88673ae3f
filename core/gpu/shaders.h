#pragma once

#include <lightcull/float3.h>
#include <lightcull/span.h>

#include <cstddef>
#include <cstdint>

/// The shaders as SPIR-V, and the constants that are pushed to them.

namespace lightcull::shaders {

Span<const std::uint32_t> refit() noexcept;
struct RefitJob {
    float reach;
    std::uint32_t key_low, key_high;
    std::uint32_t node_count, level_count;
};
static_assert(sizeof(RefitJob) == 20 && offsetof(RefitJob, node_count) == 12);

/// The shader of `culled`, and below that of `paper`, with the number of invocations in a
/// workgroup.
Span<const std::uint32_t> select() noexcept;
Span<const std::uint32_t> paper() noexcept;
inline constexpr std::uint32_t kSelectWorkgroup = 64, kPaperWorkgroup = 32;
/// The size of an entry of the list of `paper` and its CDF, bytes.
inline constexpr std::uint32_t kListEntrySize = 16;
struct SelectJob {
    float3 origin;
    float inv_scale;
    float reach;
    std::uint32_t point_count, node_count;
};
static_assert(sizeof(SelectJob) == 28 && offsetof(SelectJob, point_count) == 20);

/// The part of a Selection that a device gives.
struct Selected {
    std::uint32_t light;
    float prob;
    float weight_sum;
    std::uint32_t key;
};
static_assert(sizeof(Selected) == 16);

}  // namespace lightcull::shaders
