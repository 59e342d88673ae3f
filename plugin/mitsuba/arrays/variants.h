#pragma once

#include <mitsuba/core/spectrum.h>

namespace mitsuba::culling {

using ScalarRgb = Color<float, 3>;
using ScalarSpectrum = Spectrum<float, 4>;
using LlvmFloat = drjit::DiffArray<JitBackend::LLVM, float>;
using LlvmRgb = Color<LlvmFloat, 3>;
using LlvmSpectrum = Spectrum<LlvmFloat, 4>;

}  // namespace mitsuba::culling

// Each calls X(Float, Spectrum) once for every variant that can render, of the kind it names.
#define LIGHTCULL_SCALAR_VARIANTS(X) X(float, ScalarRgb) X(float, ScalarSpectrum)
#define LIGHTCULL_LLVM_VARIANTS(X) X(LlvmFloat, LlvmRgb) X(LlvmFloat, LlvmSpectrum)
#define LIGHTCULL_VARIANTS(X) LIGHTCULL_SCALAR_VARIANTS(X) LIGHTCULL_LLVM_VARIANTS(X)
