#include <lightcull/light_sampler.h>

#include <doctest/doctest.h>

#include <spirv_cross_c.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <set>
#include <vector>

#include "gpu/breadth_first.h"
#include "gpu/shaders.h"
#include "lights/light_groups.h"
#include "lights/light_record.h"
#include "lights/ranges.h"
#include "lights/sphere_tree.h"

using namespace lightcull;

namespace {

/// Where the members of a record lie, and where the next record begins.
struct Layout {
    std::vector<unsigned> offsets;
    unsigned stride;
};
bool operator==(const Layout& a, const Layout& b) {
    return a.offsets == b.offsets && a.stride == b.stride;
}

/// What a shader says of its memory.
class Reflection {
  public:
    explicit Reflection(Span<const std::uint32_t> code) {
        REQUIRE(spvc_context_create(&context_) == SPVC_SUCCESS);
        spvc_parsed_ir ir = nullptr;
        REQUIRE(spvc_context_parse_spirv(context_, code.data(), code.size(), &ir) == SPVC_SUCCESS);
        REQUIRE(spvc_context_create_compiler(context_, SPVC_BACKEND_NONE, ir,
                                             SPVC_CAPTURE_MODE_TAKE_OWNERSHIP,
                                             &compiler_) == SPVC_SUCCESS);
        REQUIRE(spvc_compiler_create_shader_resources(compiler_, &resources_) == SPVC_SUCCESS);
    }
    Reflection(Reflection&&) = delete;
    ~Reflection() { spvc_context_destroy(context_); }

    /// Of the elements of the buffer of a binding.
    Layout of_binding(unsigned binding) const {
        for (const spvc_reflected_resource& buffer : list(SPVC_RESOURCE_TYPE_STORAGE_BUFFER)) {
            if (spvc_compiler_get_decoration(compiler_, buffer.id, SpvDecorationBinding) !=
                binding) {
                continue;
            }
            const spvc_type block = type_of(buffer.base_type_id);
            unsigned stride = 0;
            spvc_compiler_type_struct_member_array_stride(compiler_, block, 0, &stride);
            return {offsets(spvc_type_get_member_type(block, 0)), stride};
        }
        FAIL("no such binding");
        return {};
    }
    Layout of_push_constants() const {
        const spvc_type_id id = list(SPVC_RESOURCE_TYPE_PUSH_CONSTANT)[0].base_type_id;
        std::size_t size = 0;
        spvc_compiler_get_declared_struct_size(compiler_, type_of(id), &size);
        return {offsets(id), static_cast<unsigned>(size)};
    }

  private:
    Span<const spvc_reflected_resource> list(spvc_resource_type kind) const {
        const spvc_reflected_resource* first = nullptr;
        std::size_t count = 0;
        spvc_resources_get_resource_list_for_type(resources_, kind, &first, &count);
        return {first, count};
    }
    spvc_type type_of(spvc_type_id id) const {
        return spvc_compiler_get_type_handle(compiler_, id);
    }
    std::vector<unsigned> offsets(spvc_type_id id) const {
        // The struct itself, of which arrays are made.
        const spvc_type type = type_of(spvc_type_get_base_type_id(type_of(id)));
        std::vector<unsigned> result(spvc_type_get_num_member_types(type));
        for (unsigned i = 0; i < result.size(); ++i) {
            spvc_compiler_type_struct_member_offset(compiler_, type, i, &result[i]);
        }
        return result;
    }

    spvc_context context_ = nullptr;
    spvc_compiler compiler_ = nullptr;
    spvc_resources resources_ = nullptr;
};

#define OFFSET(type, member) static_cast<unsigned>(offsetof(type, member))

template <typename Cluster>
Layout cluster_layout() {
    return {{OFFSET(Cluster, center), OFFSET(Cluster, radius), OFFSET(Cluster, spread),
             OFFSET(Cluster, intensity), OFFSET(Cluster, axis), OFFSET(Cluster, apex),
             OFFSET(Cluster, cosine), OFFSET(Cluster, mean_normal), OFFSET(Cluster, diffuse),
             OFFSET(Cluster, child)},
            sizeof(Cluster)};
}

Layout node_layout() {
    return {{OFFSET(SphereNode, x), OFFSET(SphereNode, y), OFFSET(SphereNode, z),
             OFFSET(SphereNode, link), OFFSET(SphereNode, bounds)},
            sizeof(SphereNode)};
}

Layout order_layout() {
    return {{OFFSET(BreadthFirst::Entry, node), OFFSET(BreadthFirst::Entry, place)},
            sizeof(BreadthFirst::Entry)};
}

}  // namespace

TEST_CASE("shaders have the records of the processor as they lie") {
    const Reflection select(shaders::select());
    CHECK(select.of_binding(0) == node_layout());
    CHECK(select.of_binding(1) == order_layout());
    CHECK(select.of_binding(3) == cluster_layout<ClusterMeans<1>>());
    CHECK(sizeof(LightGroup) == sizeof(ClusterMeans<1>));
    CHECK(select.of_binding(4) == cluster_layout<ClusterMeans<LightBvhNode::kWidth>>());
    CHECK(sizeof(MeansNode) == sizeof(ClusterMeans<LightBvhNode::kWidth>));
    constexpr unsigned kLobe = OFFSET(ShadingPoint, lobe);
    CHECK(select.of_binding(5) ==
          Layout{{OFFSET(ShadingPoint, position), OFFSET(ShadingPoint, normal),
                  OFFSET(ShadingPoint, set), OFFSET(ShadingPoint, diffuse),
                  kLobe + OFFSET(GlossyLobe, axis), kLobe + OFFSET(GlossyLobe, alpha),
                  kLobe + OFFSET(GlossyLobe, peak)},
                 sizeof(ShadingPoint)});
    constexpr unsigned kReceipt = OFFSET(Selection, receipt);
    CHECK(select.of_binding(7) ==
          Layout{{OFFSET(Selection, light), OFFSET(Selection, prob),
                  kReceipt + OFFSET(Receipt, weight_sum), kReceipt + OFFSET(Receipt, key)},
                 sizeof(Selection)});
    using shaders::SelectJob;
    CHECK(select.of_push_constants() ==
          Layout{{OFFSET(SelectJob, origin), OFFSET(SelectJob, inv_scale), OFFSET(SelectJob, reach),
                  OFFSET(SelectJob, point_count), OFFSET(SelectJob, node_count)},
                 sizeof(SelectJob)});

    const Reflection paper(shaders::paper());
    CHECK(paper.of_binding(0) == node_layout());
    // From the axis on, two 16-bit numbers to a word.
    constexpr unsigned kAxis = OFFSET(LightRecord, axis);
    CHECK(paper.of_binding(3) == Layout{{OFFSET(LightRecord, center), OFFSET(LightRecord, radius),
                                         OFFSET(LightRecord, intensity), kAxis, kAxis + 4,
                                         OFFSET(LightRecord, cos_theta_e)},
                                        sizeof(LightRecord)});
    CHECK(paper.of_push_constants() == select.of_push_constants());

    const Reflection refit(shaders::refit());
    CHECK(refit.of_binding(0) == node_layout());
    CHECK(refit.of_binding(1) == order_layout());
    CHECK(refit.of_binding(3) ==
          Layout{{OFFSET(float3, x), OFFSET(float3, y), OFFSET(float3, z)}, sizeof(float3)});
    CHECK(refit.of_binding(4) == Layout{{OFFSET(RangedLight, center), OFFSET(RangedLight, radius),
                                         OFFSET(RangedLight, intensity)},
                                        sizeof(RangedLight)});
    using shaders::RefitJob;
    CHECK(refit.of_push_constants() ==
          Layout{{OFFSET(RefitJob, reach), OFFSET(RefitJob, key_low), OFFSET(RefitJob, key_high),
                  OFFSET(RefitJob, node_count), OFFSET(RefitJob, level_count)},
                 sizeof(RefitJob)});
}

TEST_CASE("no arithmetic of a shader may be contracted") {
    constexpr SpvOp kRounded[] = {SpvOpFAdd, SpvOpFSub, SpvOpFMul,
                                  SpvOpFDiv, SpvOpDot,  SpvOpVectorTimesScalar};
    for (const Span<const std::uint32_t> code :
         {shaders::select(), shaders::paper(), shaders::refit()}) {
        constexpr std::size_t kHeader = 5;
        std::set<std::uint32_t> fixed, computed;
        for (std::size_t i = kHeader; i < code.size(); i += code[i] >> SpvWordCountShift) {
            const std::uint32_t op = code[i] & SpvOpCodeMask;
            if (op == SpvOpDecorate && code[i + 2] == SpvDecorationNoContraction) {
                fixed.insert(code[i + 1]);
            }
            if (std::count(std::begin(kRounded), std::end(kRounded), op) > 0) {
                computed.insert(code[i + 2]);
            }
        }
        CHECK(!computed.empty());
        for (const std::uint32_t id : computed) CHECK(fixed.count(id) == 1);
    }
}
