#include "render/ray_tracer.h"

#include "base/memory_size.h"
#include "render/embree.h"
#include "render/looseness.h"
#include "render/shadow_filter.h"

#include <lightcull/error.h>

#include <sys/types.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <string>
#include <vector>

namespace lightcull {
namespace {

constexpr std::size_t kPacket = 16;

/// A power of 2 that brings coordinates up to `reach` into the range in which Embree's products of
/// lengths are right: it takes triangles of less than some 1e-18 square metres for points, and
/// misses those whose third powers of edges floats do not hold. 1 for all but the oddest scenes.
float scale_for_embree(float reach) noexcept {
    constexpr float kLeast = 0x1p-10f, kMost = 0x1p36f;
    if (!(reach > 0.0f) || (reach >= kLeast && reach <= kMost)) return 1.0f;
    // Embree takes no numbers above 1e18; a host's points may be far beyond the scene.
    constexpr int kMostExponent = 40;
    // Large scenes shrink no more than they must: in one with a sun, a floor is of metres.
    const int wanted = reach > kMost ? std::ilogb(kMost) : 0;
    return std::ldexp(1.0f, std::min(wanted - std::ilogb(reach), kMostExponent));
}

/// The part of the way to their end that shadow rays are traced. It spares most of them a hit of
/// the light, and hides_end() has to judge the others: Embree rounds the distances of hits by some
/// units of 2^-24, and of grazing ones by more.
constexpr float kTraced = 1.0f - 0x1p-22f;

/// Fills a packet with rays in units of 1 / scale metres and returns how many of its lanes are in
/// use. Directions only grow: Embree takes small parts of them for 0.
///
/// The others repeat the last ray, its id too, and end before they begin: Embree 3 asks `valid`
/// only where the processor has vectors of 16, and else would trace what they hold.
std::size_t fill(Span<const Ray> rays, std::size_t first, float scale, RTCRay16& packet,
                 int* valid) noexcept {
    const std::size_t count = std::min(kPacket, rays.size() - first);
    const float stretch = std::max(scale, 1.0f), shortening = std::min(scale, 1.0f);
    for (std::size_t i = 0; i < kPacket; ++i) {
        const std::size_t k = std::min(i, count - 1);
        const Ray& ray = rays[first + k];
        valid[i] = i < count ? -1 : 0;
        packet.id[i] = static_cast<unsigned>(k);
        packet.org_x[i] = ray.origin.x * scale;
        packet.org_y[i] = ray.origin.y * scale;
        packet.org_z[i] = ray.origin.z * scale;
        packet.dir_x[i] = ray.direction.x * stretch;
        packet.dir_y[i] = ray.direction.y * stretch;
        packet.dir_z[i] = ray.direction.z * stretch;
        packet.tfar[i] = i < count ? ray.end * shortening : -1.0f;
    }
    return count;
}

/// Sets the fields that are the same for every packet.
void prepare(RTCRay16& packet) noexcept {
    std::memset(&packet, 0, sizeof packet);
    std::fill_n(packet.mask, kPacket, 0xffffffffu);
}

}  // namespace

struct RayTracer::Handles {
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;
    RTCGeometry geometry = nullptr;  ///< null where there are no triangles
    Span<const V3f> positions;
    Span<const std::uint32_t> indices;
    float scale = 1.0f;       ///< parts of a metre in Embree's unit of length
    std::vector<V3f> scaled;  ///< positions in that unit; none where it is the metre
    Triangles triangles{};
    bool can_be_fitted = false;
    Looseness looseness;              ///< looseness since it was built, if it can be fitted
    std::atomic<::ssize_t> bytes{0};  ///< bytes that Embree has taken and not given back

    Handles(Span<const V3f> p, Span<const std::uint32_t> i, Span<const TriangleRecord> records,
            float reach, const SceneData* cut_outs, bool to_be_fitted);
    Handles(const Handles&) = delete;
    Handles& operator=(const Handles&) = delete;
    ~Handles() {
        if (geometry != nullptr) rtcReleaseGeometry(geometry);
        if (scene != nullptr) rtcReleaseScene(scene);
        if (device != nullptr) rtcReleaseDevice(device);
    }

    void count_memory() {
        const auto add = [](void* bytes, ::ssize_t change, bool) {
            static_cast<std::atomic<::ssize_t>*>(bytes)->fetch_add(change);
            return true;
        };
        rtcSetDeviceMemoryMonitorFunction(device, add, &bytes);
    }

    /// The positions in Embree's unit of length.
    const V3f* vertices() {
        if (scale == 1.0f) return positions.data();
        scaled.reserve(positions.size() + 1);  // Embree reads 16 bytes from the last position.
        scaled.resize(positions.size());
        std::transform(positions.begin(), positions.end(), scaled.begin(),
                       [this](const V3f& p) { return p * scale; });
        return scaled.data();
    }

    void add_triangles();
    void fit();

    void check() const {
        const RTCError error = rtcGetDeviceError(device);
        if (error != RTC_ERROR_NONE) {
            throw Error("Embree failed with error " + std::to_string(static_cast<int>(error)) +
                        (error == RTC_ERROR_OUT_OF_MEMORY ? ", out of memory" : ""));
        }
    }
};

RayTracer::Handles::Handles(Span<const V3f> p, Span<const std::uint32_t> i,
                            Span<const TriangleRecord> records, float reach,
                            const SceneData* cut_outs, bool to_be_fitted)
    : positions(p),
      indices(i),
      scale(scale_for_embree(reach)),
      triangles{p.data(), i.data(), records.data(), std::min(scale, 1.0f), cut_outs},
      can_be_fitted(to_be_fitted) {
    device = rtcNewDevice(nullptr);
    check();
    count_memory();
    scene = rtcNewScene(device);
    // With ROBUST no light leaks along shared edges. Trees of other scenes than dynamic ones of low
    // quality are always built anew.
    const auto dynamic = can_be_fitted ? RTC_SCENE_FLAG_DYNAMIC : RTC_SCENE_FLAG_NONE;
    rtcSetSceneFlags(scene, static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | dynamic));
    if (can_be_fitted) {
        rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_LOW);
        looseness = Looseness(positions, indices);
    }
    if (!indices.empty()) add_triangles();
    rtcCommitScene(scene);
    check();
}

void RayTracer::Handles::add_triangles() {
    geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, vertices(),
                               0, sizeof(V3f), positions.size());
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, indices.data(),
                               0, 3 * sizeof(std::uint32_t), indices.size() / 3);
    rtcSetGeometryUserData(geometry, &triangles);
    rtcSetGeometryOccludedFilterFunction(geometry, filter_shadow_hits);
    if (triangles.cut_outs != nullptr) {
        rtcSetGeometryIntersectFilterFunction(geometry, filter_cut_outs);
    }
    if (can_be_fitted) rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_REFIT);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
}

void RayTracer::Handles::fit() {
    if (geometry == nullptr) return;
    vertices();
    rtcUpdateGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0);
    rtcCommitGeometry(geometry);
    rtcCommitScene(scene);
    check();
}

RayTracer::RayTracer(Span<const V3f> positions, Span<const std::uint32_t> indices,
                     Span<const TriangleRecord> triangles, float reach, const SceneData* cut_outs)
    : handles_(std::make_unique<Handles>(positions, indices, triangles, reach, cut_outs, false)) {
}

SceneRefit RayTracer::refit(Span<const V3f> positions, float reach, float max_growth) {
    const Handles& h = *handles_;
    SceneRefit result;
    result.rebuilt = !h.can_be_fitted || scale_for_embree(reach) != h.scale ||
                     positions.data() != h.positions.data();
    if (!result.rebuilt) {
        result.growth = h.looseness.growth(h.positions, h.indices);
        result.rebuilt = result.growth > max_growth;
    }
    if (result.rebuilt) {
        handles_ = std::make_unique<Handles>(
            positions, h.indices,
            Span<const TriangleRecord>(h.triangles.records, h.indices.size() / 3), reach,
            h.triangles.cut_outs, true);
    } else {
        handles_->fit();
    }
    return result;
}

std::size_t RayTracer::memory_size() const noexcept {
    return static_cast<std::size_t>(std::max<::ssize_t>(handles_->bytes, 0)) +
           size_of(handles_->scaled) + handles_->looseness.memory_size();
}

RayTracer::~RayTracer() = default;
RayTracer::RayTracer(RayTracer&&) noexcept = default;
RayTracer& RayTracer::operator=(RayTracer&&) noexcept = default;

void RayTracer::intersect(Span<const Ray> rays, Span<Hit> hits, bool coherent) const noexcept {
    RTCRayHit16 packet;
    alignas(64) int valid[kPacket];
    prepare(packet.ray);
    for (std::size_t first = 0; first < rays.size(); first += kPacket) {
        const std::size_t count = fill(rays, first, handles_->scale, packet.ray, valid);
        std::fill_n(packet.hit.geomID, kPacket, RTC_INVALID_GEOMETRY_ID);
        embree::intersect16(valid, handles_->scene, packet, coherent);
        for (std::size_t i = 0; i < count; ++i) {
            const bool hit = packet.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
            hits[first + i] = {hit ? packet.hit.primID[i] : kNoHit, packet.hit.u[i],
                               packet.hit.v[i]};
        }
    }
}

void RayTracer::occluded(Span<const Ray> rays, Span<std::uint8_t> occluded) const noexcept {
    RTCRay16 packet;
    alignas(64) int valid[kPacket];
    prepare(packet);
    for (std::size_t first = 0; first < rays.size(); first += kPacket) {
        const std::size_t count = fill(rays, first, handles_->scale, packet, valid);
        for (float& end : packet.tfar) end *= kTraced;
        embree::occluded16(valid, handles_->scene, packet, rays.data() + first);
        for (std::size_t i = 0; i < count; ++i) {
            occluded[first + i] = packet.tfar[i] < 0.0f ? 1 : 0;
        }
    }
}

}  // namespace lightcull
