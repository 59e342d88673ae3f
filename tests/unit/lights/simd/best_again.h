#pragma once

#include <lightcull/instruction_set.h>

namespace lightcull {

/// Makes the best instruction set the one in use again for the next test, whatever a test does.
struct BestAgain {
    ~BestAgain() { use_instruction_set(instruction_sets().front()); }
};

}  // namespace lightcull
