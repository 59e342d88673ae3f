#pragma once

#include <lightcull/export.h>

#include <string>
#include <string_view>
#include <vector>

namespace lightcull {

/// The instruction sets that selection can use on this machine, best first, as in {"AVX3", "AVX2",
/// "SSE4", "SSSE3", "scalar"}. Samplers use the best unless another is asked for; all give the same
/// bits.
LIGHTCULL_EXPORT std::vector<std::string> instruction_sets();

/// The instruction set in use.
LIGHTCULL_EXPORT std::string instruction_set();

/// Makes all samplers of the process use one of instruction_sets(), for tests and benchmarks. It
/// must be called only while no selection runs. Throws Error for a name that is not among them.
LIGHTCULL_EXPORT void use_instruction_set(std::string_view name);

}  // namespace lightcull
