#pragma once

#include <cstdint>

namespace lightcull::bench {

/// These register everything that is measured with so many lights, to be run in that order.
void register_building(std::uint32_t light_count);
void register_selection(std::uint32_t light_count);
void register_rays(std::uint32_t light_count);

}  // namespace lightcull::bench
