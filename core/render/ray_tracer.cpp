#include "render/ray_tracer.h"

#include "base/memory_size.h"
#include "render/embree.h"
#include "render/shadow_filter.h"

#include <lightcull/error.h>

#include <sys/types.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <numeric>
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
std::size_t fill(Span<const Ray> rays, std::size_t first, float scale, RTCRay16& packet,
                 int* valid) noexcept {
    const std::size_t count = std::min(kPacket, rays.size() - first);
    const float stretch = std::max(scale, 1.0f), shortening = std::min(scale, 1.0f);
    for (std::size_t i = 0; i < kPacket; ++i) {
        // Idle lanes repeat the last ray, so that they hold numbers.
        const Ray& ray = rays[first + std::min(i, count - 1)];
        valid[i] = i < count ? -1 : 0;
        packet.org_x[i] = ray.origin.x * scale;
        packet.org_y[i] = ray.origin.y * scale;
        packet.org_z[i] = ray.origin.z * scale;
        packet.dir_x[i] = ray.direction.x * stretch;
        packet.dir_y[i] = ray.direction.y * stretch;
        packet.dir_z[i] = ray.direction.z * stretch;
        packet.tfar[i] = ray.end * shortening;
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
    float scale = 1.0f;       ///< parts of a metre in Embree's unit of length
    std::vector<V3f> scaled;  ///< positions in that unit; none where it is the metre
    Triangles triangles{};
    std::atomic<::ssize_t> bytes{0};  ///< bytes that Embree has taken and not given back

    Handles() = default;
    Handles(const Handles&) = delete;
    Handles& operator=(const Handles&) = delete;
    ~Handles() {
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

    /// Sets the unit of length and returns the positions in it.
    const V3f* rescaled(Span<const V3f> positions, float reach) {
        scale = scale_for_embree(reach);
        if (scale == 1.0f) return positions.data();
        scaled.reserve(positions.size() + 1);  // Embree reads 16 bytes from the last position.
        for (const V3f& p : positions) scaled.push_back(p * scale);
        return scaled.data();
    }

    void check() const {
        const RTCError error = rtcGetDeviceError(device);
        if (error != RTC_ERROR_NONE) {
            throw Error("Embree failed with error " + std::to_string(static_cast<int>(error)) +
                        (error == RTC_ERROR_OUT_OF_MEMORY ? ", out of memory" : ""));
        }
    }
};

RayTracer::RayTracer(Span<const V3f> positions, Span<const std::uint32_t> indices,
                     Span<const TriangleRecord> triangles, float reach, const SceneData* cut_outs)
    : handles_(std::make_unique<Handles>()) {
    handles_->device = rtcNewDevice(nullptr);
    handles_->check();
    handles_->count_memory();
    handles_->scene = rtcNewScene(handles_->device);
    // With this flag no light leaks along shared edges.
    rtcSetSceneFlags(handles_->scene, RTC_SCENE_FLAG_ROBUST);
    if (!indices.empty()) {
        const V3f* vertices = handles_->rescaled(positions, reach);
        RTCGeometry geometry = rtcNewGeometry(handles_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, vertices,
                                   0, sizeof(V3f), positions.size());
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                   indices.data(), 0, 3 * sizeof(std::uint32_t),
                                   indices.size() / 3);
        handles_->triangles = {positions.data(), indices.data(), triangles.data(),
                               std::min(handles_->scale, 1.0f), cut_outs};
        rtcSetGeometryUserData(geometry, &handles_->triangles);
        rtcSetGeometryOccludedFilterFunction(geometry, filter_shadow_hits);
        if (cut_outs != nullptr) {
            rtcSetGeometryIntersectFilterFunction(geometry, filter_cut_outs);
        }
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(handles_->scene, geometry);
        rtcReleaseGeometry(geometry);
    }
    rtcCommitScene(handles_->scene);
    handles_->check();
}

std::size_t RayTracer::memory_size() const noexcept {
    return static_cast<std::size_t>(std::max<::ssize_t>(handles_->bytes, 0)) +
           size_of(handles_->scaled);
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
    std::iota(packet.id, packet.id + kPacket, 0u);
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
