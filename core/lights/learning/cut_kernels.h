#pragma once

#include <cstdint>

#include "lights/learning/cluster_cut.h"
#include "lights/learning/light_rows.h"
#include "lights/light/receiver.h"

namespace lightcull {

/// The work that is done with cuts, for one instruction set; all of them give the same bits.
struct CutKernels {
    /// Weighs all clusters of a cut, and opens what a lobe asks for (CutWeights).
    void (*weigh)(const LightBvh<MeansNode>& bvh, const ClusterCut& cut, const Receiver& receiver,
                  CutWeights& weights);

    /// The weight of one of them, to the bit that of weigh() where it was not opened.
    float (*weight_of)(const ClusterCut& cut, std::uint32_t place, const Receiver& receiver);

    /// Weighs each light: its importance by its factor.
    void (*weigh_lights)(const LightRows& lights, const LightFactors& factors,
                         const Receiver& receiver, LightWeights& weights);

    /// The importance of one of them, to the bit that of weigh_lights().
    float (*importance_of_light)(const LightRows& lights, std::size_t place,
                                 const Receiver& receiver);
};

/// The kernels for the instruction set in use.
const CutKernels& cut_kernels() noexcept;

}  // namespace lightcull
