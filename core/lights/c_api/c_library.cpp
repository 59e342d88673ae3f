#include <lightcull/instruction_set.h>
#include <lightcull/lightcull.h>
#include <lightcull/sets.h>
#include <lightcull/version.h>

#include <algorithm>
#include <string>
#include <vector>

#include "lights/c_api/c_error.h"

using namespace lightcull;

static_assert(LIGHTCULL_POINTS_PER_PACKET == kPointsPerPacket);

uint32_t lightcull_set_of_pixel(uint32_t x, uint32_t y, uint64_t pass, uint32_t set_count) {
    return set_of_pixel(x, y, pass, set_count);
}

uint32_t lightcull_set_of_packet(uint32_t packet, uint32_t set_count) {
    return set_of_packet(packet, set_count);
}

uint32_t lightcull_set_of_sample(uint32_t x, uint32_t y, uint32_t sample, uint32_t bounce,
                                 uint32_t set_count) {
    return set_of_sample(x, y, sample, bounce, set_count);
}

const char* lightcull_version(void) {
    return lightcull::version();
}

const char* lightcull_instruction_set(void) {
    const char* found = nullptr;
    guarded([&] {
        static const std::vector<std::string> names = instruction_sets();
        found = std::find(names.begin(), names.end(), instruction_set())->c_str();
    });
    return found;
}

lightcull_error lightcull_use_instruction_set(const char* name) {
    return guarded([&] {
        check_not_null(name, "name");
        use_instruction_set(name);
    });
}
