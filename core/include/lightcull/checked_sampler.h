#pragma once

#include <lightcull/export.h>
#include <lightcull/light_sampler.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <string>

namespace lightcull {

/// A function that is told, in one line, what a host does wrong. It may be called from any thread.
using FaultHandler = std::function<void(const std::string& fault)>;

/// A sampler, or a pass() of it, that checks what the hot calls are given, for finding a host's
/// faults: positions and normals that are not finite, normals whose length is neither 1 nor 0,
/// lobes out of range, sets and keys of receipts that are not below set_count(), u outside [0, 1),
/// spans of different lengths, lights of prob() that there are none of, and selections before the
/// first begin_pass(). Each call that finds a fault tells `on_fault`, selects nothing (prob 0), and
/// does not reach the sampler. Without a handler the fault is printed to the standard error, and
/// the process aborted. Calls without a fault are answered by the sampler, to the bit.
///
/// light_count: number of lights that the sampler was made over. The checked sampler has no
/// SamplerInfo. Throws Error where `sampler` is null, or one that decides at the vertex
/// (VertexCulling).
LIGHTCULL_EXPORT std::unique_ptr<LightSampler> make_checked_sampler(
    std::unique_ptr<LightSampler> sampler, std::size_t light_count, FaultHandler on_fault = {});

}  // namespace lightcull
