#pragma once

#include <lightcull/export.h>

#include <cstdint>

namespace lightcull {

/// The rules by which a point uses one of the sets of random ranges of a pass. Points that share a
/// set share their luck: where neighbours do, the error is banded ([TH16] section 6.1).
///
/// A pass of up to 256 sets is one draw of a number for each light, and its sets are rotations of
/// that draw, spread evenly. A pass of more is several draws of 256 rotations each, independent of
/// one another: it is as good as that many passes.
///
/// - A host that begins a pass for each sample of the image has 16 to 256 sets, of which camera
///   points use set_of_pixel() and later bounces set_of_packet().
/// - A host that finishes tiles has as many sets as it gets by default, shares one pass() among all
///   tiles for every set_count samples, and uses set_of_sample().
/// - Where passes must take little memory, each tile may take a pass() of its own for every 16
///   samples, of 64 sets (with 16, a tile as a whole is too bright or dark by luck), and use
///   set_of_sample().

/// The set for camera points of pixel (x, y) in a pass. The pixels of a square of 4x4 take evenly
/// spread rotations of one draw, neighbours far apart. Where squares lie, and with which rotation
/// and draw each begins, is hashed from the pass, so that no two pixels share their luck for longer
/// than a pass. set_count is a power of 4. For hosts that begin a pass for each sample: within one
/// pass it gives a pixel the same set again and again.
LIGHTCULL_EXPORT std::uint32_t set_of_pixel(std::uint32_t x, std::uint32_t y, std::uint64_t pass,
                                            std::uint32_t set_count) noexcept;

/// The number of points that lie together and share a set at later bounces: sort all points of a
/// bounce along a curve in space, and cut them into packets of this many.
inline constexpr std::uint32_t kPointsPerPacket = 16;

/// The set for the points of packet `packet` of later bounces. It takes no more than 16 of the
/// sets, so that a bounce touches little memory: for hosts that begin a pass for each sample.
LIGHTCULL_EXPORT std::uint32_t set_of_packet(std::uint32_t packet,
                                             std::uint32_t set_count) noexcept;

/// The set for a sample of pixel (x, y) at a vertex of its path: bounce 0 is what the camera sees.
/// The samples of a pixel take all sets in turn: the rotations of a draw, any first few of them
/// evenly spread, then those of the next draw. Neighbours take others at the same time. For hosts
/// that select from one pass for many samples; after set_count samples it begins anew, and a host
/// goes on with another pass. set_count is a power of 4.
LIGHTCULL_EXPORT std::uint32_t set_of_sample(std::uint32_t x, std::uint32_t y, std::uint32_t sample,
                                             std::uint32_t bounce,
                                             std::uint32_t set_count) noexcept;

}  // namespace lightcull
