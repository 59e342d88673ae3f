#include "render/ray_tracer.h"

#include "base/memory_size.h"
#include "render/embree.h"
#include "render/looseness.h"
#include "render/scene_data.h"
#include "render/shadow_filter.h"

#include <lightcull/error.h>

#include <sys/types.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <deque>
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
    const SceneData& data;
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;
    const V3f* positions;                 ///< place of the positions that it was built for
    float scale = 1.0f;                   ///< parts of a metre in Embree's unit of length
    std::vector<V3f> scaled;              ///< positions in that unit; none where it is the metre
    std::vector<RTCGeometry> geometries;  ///< triangles that stand, then instances, by Embree's ids
    std::vector<RTCScene> shared;       ///< scenes of the meshes that instances place, by their ids
    std::deque<Triangles> triangles;    ///< what filters know; they stay where they are
    std::vector<std::uint32_t> firsts;  ///< first triangles of the geometries that stand
    bool can_be_fitted = false;
    Looseness looseness;              ///< looseness since it was built, if it can be fitted
    std::atomic<::ssize_t> bytes{0};  ///< bytes that Embree has taken and not given back

    Handles(const SceneData& scene_data, float reach, bool to_be_fitted);
    Handles(const Handles&) = delete;
    Handles& operator=(const Handles&) = delete;
    ~Handles() {
        for (RTCGeometry geometry : geometries) rtcReleaseGeometry(geometry);
        for (RTCScene part : shared) {
            if (part != nullptr) rtcReleaseScene(part);
        }
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
        if (scale == 1.0f) return data.positions.data();
        const auto& all = data.positions;
        scaled.reserve(all.size() + 1);  // Embree reads 16 bytes from the last position.
        scaled.resize(all.size());
        std::transform(all.begin(), all.end(), scaled.begin(),
                       [this](const V3f& p) { return p * scale; });
        return scaled.data();
    }

    RTCScene new_scene() const;
    RTCGeometry new_triangles(std::size_t first, std::size_t end);
    void add_triangles();
    void add_shared_meshes();
    void add_instances();
    void fit();
    Hit hit_of(const RTCHit16& hits, std::size_t lane) const noexcept;

    void check() const {
        const RTCError error = rtcGetDeviceError(device);
        if (error != RTC_ERROR_NONE) {
            throw Error("Embree failed with error " + std::to_string(static_cast<int>(error)) +
                        (error == RTC_ERROR_OUT_OF_MEMORY ? ", out of memory" : ""));
        }
    }
};

RayTracer::Handles::Handles(const SceneData& scene_data, float reach, bool to_be_fitted)
    : data(scene_data),
      positions(scene_data.positions.data()),
      scale(scale_for_embree(reach)),
      can_be_fitted(to_be_fitted) {
    device = rtcNewDevice(nullptr);
    check();
    count_memory();
    scene = new_scene();
    if (can_be_fitted) {
        rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_LOW);
        looseness = Looseness(data.positions, data.indices);
    }
    vertices();
    add_triangles();
    if (!data.instances.empty()) {
        add_shared_meshes();
        add_instances();
    }
    rtcCommitScene(scene);
    check();
}

RTCScene RayTracer::Handles::new_scene() const {
    const RTCScene made = rtcNewScene(device);
    // With ROBUST no light leaks along shared edges. Trees of other scenes than dynamic ones of low
    // quality are always built anew.
    const auto dynamic = can_be_fitted ? RTC_SCENE_FLAG_DYNAMIC : RTC_SCENE_FLAG_NONE;
    rtcSetSceneFlags(made, static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | dynamic));
    return made;
}

/// A geometry of some of the triangles.
RTCGeometry RayTracer::Handles::new_triangles(std::size_t first, std::size_t end) {
    triangles.push_back({&data, static_cast<std::uint32_t>(first),
                         static_cast<std::uint32_t>(firsts.size()), std::min(scale, 1.0f)});
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                               scale == 1.0f ? data.positions.data() : scaled.data(), 0,
                               sizeof(V3f), data.positions.size());
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               data.indices.data(), 3 * sizeof(std::uint32_t) * first,
                               3 * sizeof(std::uint32_t), end - first);
    rtcSetGeometryUserData(geometry, &triangles.back());
    rtcSetGeometryOccludedFilterFunction(geometry, filter_shadow_hits);
    if (data.has_cut_outs) rtcSetGeometryIntersectFilterFunction(geometry, filter_cut_outs);
    return geometry;
}

/// Adds the triangles that stand: those between shared meshes are a geometry each.
void RayTracer::Handles::add_triangles() {
    const auto count = static_cast<MeshId>(data.meshes.size());
    for (MeshId mesh = 0; mesh < count;) {
        if (data.meshes[mesh].is_shared) {
            ++mesh;
            continue;
        }
        const std::size_t first = data.triangles_of(mesh).begin;
        std::size_t end = first;
        for (; mesh < count && !data.meshes[mesh].is_shared; ++mesh) {
            end = data.triangles_of(mesh).end;
        }
        if (end == first) continue;
        const RTCGeometry geometry = geometries.emplace_back(new_triangles(first, end));
        if (can_be_fitted) rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_REFIT);
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(scene, geometry, static_cast<unsigned>(firsts.size()));
        firsts.push_back(static_cast<std::uint32_t>(first));
    }
}

void RayTracer::Handles::add_shared_meshes() {
    shared.resize(data.meshes.size());
    for (const Instance& instance : data.instances) {
        RTCScene& part = shared[instance.mesh];
        if (part != nullptr) continue;
        part = new_scene();
        const SceneData::Range range = data.triangles_of(instance.mesh);
        if (range.size() > 0) {
            const RTCGeometry geometry = new_triangles(range.begin, range.end);
            rtcCommitGeometry(geometry);
            rtcAttachGeometry(part, geometry);
            rtcReleaseGeometry(geometry);
        }
        rtcCommitScene(part);
    }
}

void RayTracer::Handles::add_instances() {
    for (const Instance& instance : data.instances) {
        const RTCGeometry geometry =
            geometries.emplace_back(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE));
        rtcSetGeometryInstancedScene(geometry, shared[instance.mesh]);
        float rows[12];
        for (std::size_t k = 0; k < 3; ++k) {
            const V3f& row = instance.rows[k];
            const float moved = instance.translation[static_cast<int>(k)] * scale;
            std::copy_n(std::array{row.x, row.y, row.z, moved}.begin(), 4, rows + 4 * k);
        }
        rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, rows);
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(scene, geometry, static_cast<unsigned>(geometries.size() - 1));
    }
}

void RayTracer::Handles::fit() {
    vertices();
    for (std::size_t i = 0; i < firsts.size(); ++i) {
        rtcUpdateGeometryBuffer(geometries[i], RTC_BUFFER_TYPE_VERTEX, 0);
        rtcCommitGeometry(geometries[i]);
    }
    rtcCommitScene(scene);
    check();
}

/// What a lane of a packet has hit.
Hit RayTracer::Handles::hit_of(const RTCHit16& hits, std::size_t lane) const noexcept {
    const unsigned geometry = hits.geomID[lane], placed = hits.instID[0][lane];
    if (geometry == RTC_INVALID_GEOMETRY_ID) return {kNoHit, hits.u[lane], hits.v[lane]};
    if (placed == RTC_INVALID_GEOMETRY_ID) {
        return {firsts[geometry] + hits.primID[lane], hits.u[lane], hits.v[lane]};
    }
    const auto instance = placed - static_cast<std::uint32_t>(firsts.size());
    const MeshRecord& mesh = data.meshes[data.instances[instance].mesh];
    return {mesh.first_triangle + hits.primID[lane], hits.u[lane], hits.v[lane], instance};
}

RayTracer::RayTracer(const SceneData& scene, float reach)
    : handles_(std::make_unique<Handles>(scene, reach, false)) {
}

SceneRefit RayTracer::refit(float reach, float max_growth) {
    const Handles& h = *handles_;
    SceneRefit result;
    result.rebuilt = !h.can_be_fitted || scale_for_embree(reach) != h.scale ||
                     h.data.positions.data() != h.positions;
    if (!result.rebuilt) {
        result.growth = h.looseness.growth(h.data.positions, h.data.indices);
        result.rebuilt = result.growth > max_growth;
    }
    if (result.rebuilt) {
        handles_ = std::make_unique<Handles>(h.data, reach, true);
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
        std::fill_n(packet.hit.instID[0], kPacket, RTC_INVALID_GEOMETRY_ID);
        embree::intersect16(valid, handles_->scene, packet, coherent);
        for (std::size_t i = 0; i < count; ++i) {
            hits[first + i] = handles_->hit_of(packet.hit, i);
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
