#include <lightcull/light_sampler.h>

#include <doctest/doctest.h>

#include <spirv_cross_c.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <set>
#include <type_traits>
#include <vector>

#include "gpu/breadth_first.h"
#include "gpu/shaders.h"
#include "lights/groups/light_groups.h"
#include "lights/light/light_record.h"
#include "lights/ranges/ranges.h"
#include "lights/ranges/sphere_tree.h"

using namespace lightcull;

namespace {

/// The place of a member of a record.
struct Member {
    std::size_t offset, size;
    bool is_float;  ///< a float, or an array or float3 of floats; else integers
};
bool operator==(const Member& a, const Member& b) {
    return a.offset == b.offset && a.size == b.size && a.is_float == b.is_float;
}

/// The members of a record, and the place where the next record begins.
struct Layout {
    std::vector<Member> members;
    std::size_t stride;
};
bool operator==(const Layout& a, const Layout& b) {
    return a.members == b.members && a.stride == b.stride;
}

/// The layout of its memory that a shader tells.
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

    std::size_t buffer_count() const { return list(SPVC_RESOURCE_TYPE_STORAGE_BUFFER).size(); }

    /// The layout of the elements of the buffer of a binding.
    Layout of_binding(unsigned binding) const {
        for (const spvc_reflected_resource& buffer : list(SPVC_RESOURCE_TYPE_STORAGE_BUFFER)) {
            if (spvc_compiler_get_decoration(compiler_, buffer.id, SpvDecorationBinding) !=
                binding) {
                continue;
            }
            const spvc_type block = type_of(buffer.base_type_id);
            CHECK(spvc_type_get_num_member_types(block) == 1);
            unsigned stride = 0;
            spvc_compiler_type_struct_member_array_stride(compiler_, block, 0, &stride);
            return {members_of(spvc_type_get_member_type(block, 0)), stride};
        }
        FAIL("no such binding");
        return {};
    }
    Layout of_push_constants() const {
        const spvc_type_id id = list(SPVC_RESOURCE_TYPE_PUSH_CONSTANT)[0].base_type_id;
        std::size_t size = 0;
        spvc_compiler_get_declared_struct_size(compiler_, type_of(id), &size);
        return {members_of(id), size};
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
    /// The members of a struct, or of the one that an array is made of; a number counts as its only
    /// member.
    std::vector<Member> members_of(spvc_type_id id) const {
        const spvc_type type = type_of(spvc_type_get_base_type_id(type_of(id)));
        std::vector<Member> result(spvc_type_get_num_member_types(type));
        for (unsigned i = 0; i < result.size(); ++i) {
            unsigned offset = 0;
            spvc_compiler_type_struct_member_offset(compiler_, type, i, &offset);
            result[i].offset = offset;
            spvc_compiler_get_declared_struct_member_size(compiler_, type, i, &result[i].size);
            const spvc_type_id member = spvc_type_get_member_type(type, i);
            result[i].is_float = is_float(member);
            const spvc_type inner = type_of(spvc_type_get_base_type_id(type_of(member)));
            if (spvc_type_get_basetype(inner) == SPVC_BASETYPE_STRUCT) {
                CHECK(members_of(member) ==
                      std::vector<Member>{{0, 4, true}, {4, 4, true}, {8, 4, true}});
            }
        }
        if (result.empty()) result.push_back({0, 4, is_float(id)});
        return result;
    }
    bool is_float(spvc_type_id id) const {
        const spvc_basetype type = spvc_type_get_basetype(type_of(id));
        CHECK((type == SPVC_BASETYPE_FP32 || type == SPVC_BASETYPE_UINT32 ||
               type == SPVC_BASETYPE_STRUCT));
        return type != SPVC_BASETYPE_UINT32;
    }

    spvc_context context_ = nullptr;
    spvc_compiler compiler_ = nullptr;
    spvc_resources resources_ = nullptr;
};

static_assert(sizeof(float3) == 12 && offsetof(float3, y) == 4 && offsetof(float3, z) == 8);

template <typename T>
Member member_at(std::size_t offset) {
    using Element = std::remove_all_extents_t<T>;
    return {offset, sizeof(T), std::is_same_v<Element, float> || std::is_same_v<Element, float3>};
}
#define MEMBER(type, member) member_at<decltype(type::member)>(offsetof(type, member))

template <typename Number>
Layout array_of() {
    return {{member_at<Number>(0)}, sizeof(Number)};
}

template <typename Cluster, typename Record>
Layout clusters() {
    return {{MEMBER(Cluster, center), MEMBER(Cluster, radius), MEMBER(Cluster, spread),
             MEMBER(Cluster, intensity), MEMBER(Cluster, axis), MEMBER(Cluster, apex),
             MEMBER(Cluster, cosine), MEMBER(Cluster, mean_normal), MEMBER(Cluster, diffuse),
             MEMBER(Cluster, child)},
            sizeof(Record)};
}

Layout nodes() {
    return {{MEMBER(SphereNode, x), MEMBER(SphereNode, y), MEMBER(SphereNode, z),
             MEMBER(SphereNode, link), MEMBER(SphereNode, bounds)},
            sizeof(SphereNode)};
}

Layout order() {
    using Entry = BreadthFirst::Entry;
    return {{MEMBER(Entry, node), MEMBER(Entry, place)}, sizeof(Entry)};
}

/// The layout of light records: from the axis on, two 16-bit numbers to a word.
Layout light_records() {
    constexpr std::size_t kAxis = offsetof(LightRecord, axis);
    static_assert(offsetof(LightRecord, half_sine_o) == kAxis + 6);
    return {{MEMBER(LightRecord, center), MEMBER(LightRecord, radius),
             MEMBER(LightRecord, intensity), Member{kAxis, 4, false}, Member{kAxis + 4, 4, false},
             Member{offsetof(LightRecord, sin_theta_e), 4, false}},
            sizeof(LightRecord)};
}

Layout points() {
    constexpr std::size_t kLobe = offsetof(ShadingPoint, lobe);
    return {
        {MEMBER(ShadingPoint, position), MEMBER(ShadingPoint, normal), MEMBER(ShadingPoint, set),
         MEMBER(ShadingPoint, diffuse), member_at<float3>(kLobe + offsetof(GlossyLobe, axis)),
         member_at<float>(kLobe + offsetof(GlossyLobe, alpha)),
         member_at<float>(kLobe + offsetof(GlossyLobe, peak))},
        sizeof(ShadingPoint)};
}

Layout selections() {
    using shaders::Selected;
    return {{MEMBER(Selected, light), MEMBER(Selected, prob), MEMBER(Selected, weight_sum),
             MEMBER(Selected, key)},
            sizeof(Selected)};
}

Layout select_job() {
    using shaders::SelectJob;
    return {{MEMBER(SelectJob, origin), MEMBER(SelectJob, inv_scale), MEMBER(SelectJob, reach),
             MEMBER(SelectJob, point_count), MEMBER(SelectJob, node_count)},
            sizeof(SelectJob)};
}

Layout refit_job() {
    using shaders::RefitJob;
    return {{MEMBER(RefitJob, reach), MEMBER(RefitJob, key_low), MEMBER(RefitJob, key_high),
             MEMBER(RefitJob, node_count), MEMBER(RefitJob, level_count)},
            sizeof(RefitJob)};
}

/// Checks all buffers that there are, in the order of the bindings.
void check(Span<const std::uint32_t> code, const std::vector<Layout>& buffers, const Layout& job) {
    const Reflection shader(code);
    CHECK(shader.buffer_count() == buffers.size());
    for (unsigned i = 0; i < buffers.size(); ++i) {
        CAPTURE(i);
        CHECK(shader.of_binding(i) == buffers[i]);
    }
    CHECK(shader.of_push_constants() == job);
}

}  // namespace

TEST_CASE("shaders have the records of the processor as they lie") {
    const Layout groups = clusters<ClusterMeans<1>, LightGroup>(),
                 bvh = clusters<ClusterMeans<LightBvhNode::kWidth>, MeansNode>(),
                 floats = array_of<float>(), numbers = array_of<std::uint32_t>(),
                 centers{{MEMBER(float3, x), MEMBER(float3, y), MEMBER(float3, z)}, sizeof(float3)},
                 ranged{{MEMBER(RangedLight, center), MEMBER(RangedLight, radius),
                         MEMBER(RangedLight, intensity)},
                        sizeof(RangedLight)},
                 turns{{MEMBER(RandomRanges::Turn, rank), MEMBER(RandomRanges::Turn, draw)},
                       sizeof(RandomRanges::Turn)};
    SUBCASE("select") {
        check(shaders::select(),
              {nodes(), order(), floats, groups, bvh, points(), floats, selections()},
              select_job());
    }
    SUBCASE("paper") {
        check(shaders::paper(),
              {nodes(), order(), floats, light_records(), numbers, points(), floats, selections()},
              select_job());
    }
    SUBCASE("refit") {
        check(shaders::refit(), {nodes(), order(), floats, centers, ranged, numbers, turns, floats},
              refit_job());
    }
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
