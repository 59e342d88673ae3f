#include "virtual_lights/volumes/bounding_volume.h"
#include "base/random.h"
#include "render/warp.h"
#include "virtual_lights/tiles/tile_bounds.h"
#include "virtual_lights/volumes/box_tree.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

using namespace lightcull;

namespace {

constexpr BoundingVolume kVolumes[] = {BoundingVolume::kSpheroid, BoundingVolume::kSphereAround,
                                       BoundingVolume::kSphereAtLight};

V3f random_direction(RandomStream& random) {
    const float z = 2.0f * random.next() - 1.0f, angle = 2.0f * kPi * random.next();
    const float s = std::sqrt(1.0f - z * z);
    return {s * std::cos(angle), s * std::sin(angle), z};
}

/// A light of some normal, incoming direction above it, and reflectance.
VirtualLight random_light(RandomStream& random, Lobe lobe, float alpha) {
    const V3f normal = random_direction(random);
    // Every fourth light comes in at a grazing angle.
    const float cosine = random.next() < 0.25f ? 0.01f : 0.01f + 0.98f * random.next();
    const float sine = std::sqrt(1.0f - cosine * cosine), angle = 2.0f * kPi * random.next();
    const V3f incoming =
        unit(Basis(normal).to_world({sine * std::cos(angle), sine * std::sin(angle), cosine}));
    const V3f f0(random.next(), 0.04f, random.next());
    return {
        V3f(random.next(), 2.0f, -1.0f), normal, incoming, V3f(1.0f, 2.0f, 0.5f), f0, alpha, lobe};
}

/// The distance of a place from the centre of the spheroid, in radii: 1 on it.
double stretched_distance(const Spheroid& s, const V3f& place) {
    const Imath::V3d way = Imath::V3d(place) - Imath::V3d(s.center);
    const Imath::V3d axis = Imath::V3d(s.axis).normalized();
    const double along = way.dot(axis) / static_cast<double>(s.half_length);
    const double across = way.cross(axis).length() / static_cast<double>(s.radius);
    return std::sqrt(along * along + across * across);
}

/// Directions above the light, every other one within a few alphas of the mirror direction.
V3f direction_above(const VirtualLight& light, RandomStream& random, int i) {
    for (;;) {
        V3f w = random_direction(random);
        if (i % 2 == 0) {
            const V3f mirrored =
                light.normal * (2.0f * light.normal.dot(light.incoming)) - light.incoming;
            w = unit(mirrored + w * (light.alpha * 20.0f * random.next() * random.next()));
        }
        if (light.normal.dot(w) > 0.0f) return w;
    }
}

/// The most that a light's isosurface sticks out of its volume, in radii of the volume.
double worst(Lobe lobe, float alpha, BoundingVolume kind, int directions, std::uint64_t key) {
    RandomStream random(key);
    double most = 0.0;
    constexpr int kPerLight = 100;
    for (int i = 0; i < directions / kPerLight; ++i) {
        const VirtualLight light = random_light(random, lobe, alpha);
        const float scale = std::exp2(20.0f * random.next() - 10.0f);
        const Spheroid volume = bounding_volume(light, scale, kind);
        for (int j = 0; j < kPerLight; ++j) {
            const V3f w = direction_above(light, random, j);
            const float range = std::sqrt(scale * luminance(intensity(light, w)));
            most = std::max(most, stretched_distance(volume, light.position + w * range));
        }
    }
    return most;
}

}  // namespace

TEST_CASE("bounding volumes: nothing with p > xi lies outside, whatever the roughness") {
    constexpr int kDirections = 1000000;
    for (const BoundingVolume kind : kVolumes) {
        CHECK(worst(Lobe::kDiffuse, 1.0f, kind, kDirections, 1) <= 1.0);
        CHECK(worst(Lobe::kUnderGloss, 1.0f, kind, kDirections, 2) <= 1.0);
        for (const float alpha : {1e-3f, 3e-3f, 0.01f, 0.1f, 0.3f, 0.7f, 1.0f}) {
            CAPTURE(alpha);
            CAPTURE(static_cast<int>(kind));
            CHECK(worst(Lobe::kGlossy, alpha, kind, kDirections, 3) <= 1.0);
        }
    }
}

TEST_CASE("bounding volumes: the diffuse sphere and the spheroid could not be smaller") {
    // The isosurface touches the sphere at the widest place, and is not held by one whose centre is
    // where the paper prints it.
    RandomStream random(4);
    const VirtualLight light = random_light(random, Lobe::kDiffuse, 1.0f);
    const Spheroid sphere = bounding_volume(light, 1.0f, BoundingVolume::kSpheroid);
    CHECK(worst(Lobe::kDiffuse, 1.0f, BoundingVolume::kSpheroid, 100000, 5) > 0.998);
    const float range = std::sqrt(luminance(light.strength));
    const V3f printed = light.position + light.normal * (range * std::pow(1.0f / 3.0f, 0.25f));
    CHECK((printed - light.position).length() > sphere.radius);

    // The shape of [TH17] Eq. 12 is a spheroid: the isosurface lies on it in every direction.
    for (const float alpha : {1e-3f, 0.05f, 0.5f, 1.0f}) {
        const VirtualLight glossy = random_light(random, Lobe::kGlossy, alpha);
        const Spheroid s = bounding_volume(glossy, 3.0f, BoundingVolume::kSpheroid);
        const double longest =
            std::sqrt(3.0 * static_cast<double>(intensity_bound(glossy))) * 1.001;
        const double a2 = static_cast<double>(alpha) * static_cast<double>(alpha);
        for (int i = 0; i < 1000; ++i) {
            const V3f w = random_direction(random);
            const double cosine = static_cast<double>(w.dot(s.axis));
            const double c2 = 0.5 * (1.0 + cosine), s2 = 0.5 * (1.0 - cosine);
            const double distance = longest * a2 / (a2 * c2 + s2);
            const V3f place = glossy.position + w * static_cast<float>(distance);
            CHECK(stretched_distance(s, place) == doctest::Approx(1.0).scale(0.0).epsilon(1e-3));
        }
    }
    // With the light in the plane of incidence, Fresnel 1 and rough masking, the bound is reached
    // there.
    VirtualLight metal = random_light(random, Lobe::kGlossy, 0.02f);
    metal.f0 = V3f(1.0f);
    metal.incoming = unit(metal.normal + Basis(metal.normal).tangent * 0.2f);
    const V3f mirrored = metal.normal * (2.0f * metal.normal.dot(metal.incoming)) - metal.incoming;
    const Spheroid s = bounding_volume(metal, 1.0f, BoundingVolume::kSpheroid);
    const V3f tip = metal.position + mirrored * std::sqrt(luminance(intensity(metal, mirrored)));
    CHECK(stretched_distance(s, tip) == doctest::Approx(1.0).scale(0.0).epsilon(4e-3));
}

TEST_CASE("tiles: a light whose volume holds a point of the tile is never culled") {
    Camera camera;
    camera.origin = {3, 1, 2};
    camera.target = {0, 0, 0};
    const CameraRays rays(camera, 64, 64);
    RandomStream random(6);
    int tested = 0, kept = 0, inside = 0;
    for (int tile = 0; tile < 2000; ++tile) {
        // Points about a place in front of the camera, at two depths.
        const V2f corner(48.0f * random.next(), 48.0f * random.next());
        const float depth = 0.5f + 5.0f * random.next();
        std::vector<V3f> places, views;
        for (int i = 0; i < 64; ++i) {
            const V2f pixel = corner + V2f(random.next(), random.next()) * 16.0f;
            const Ray ray = rays.ray(pixel, {0.5f, 0.5f});
            const float t = depth * (1.0f + 0.1f * random.next()) * (i % 3 == 0 ? 2.0f : 1.0f);
            places.push_back(ray.origin + ray.direction * t);
            views.push_back(rays.to_view(places.back() - rays.origin()));
        }
        const TileBounds bounds{Span<const V3f>(views)};
        for (int i = 0; i < 50; ++i) {
            const bool glossy = i % 2 == 0;
            const float alpha = std::exp2(-10.0f * random.next());
            VirtualLight light =
                random_light(random, glossy ? Lobe::kGlossy : Lobe::kDiffuse, alpha);
            light.position = places[0] + random_direction(random) * (3.0f * random.next());
            const float scale = std::exp2(-10.0f * random.next());
            for (const BoundingVolume kind : kVolumes) {
                const Spheroid volume = bounding_volume(light, scale, kind);
                const VolumeInView in_view(volume, rays);
                const AlignedBox box = box_in_view(volume, rays);
                const BoxTree tree({&box, 1});
                for (std::uint32_t c = 0; c < TileBounds::kClusters; ++c) {
                    bool holds = false;
                    for (std::size_t k = 0; k < places.size(); ++k) {
                        if (bounds.cluster_of(views[k]) != c) continue;
                        holds = holds || stretched_distance(volume, places[k]) <= 1.0;
                    }
                    bool overlaps = false;
                    tree.for_overlapping(bounds.piece(c).box(), [&](std::uint32_t) {
                        overlaps = in_view.overlaps(bounds.piece(c));
                    });
                    ++tested;
                    kept += overlaps ? 1 : 0;
                    inside += holds ? 1 : 0;
                    if (holds) CHECK(overlaps);
                }
            }
        }
    }
    // The volume culls, and does not keep much more than it must.
    CHECK(inside > 20000);
    CHECK(kept < tested / 2);
    CHECK(kept < 2 * inside);
}

TEST_CASE("tiles: without geometry nothing overlaps") {
    const CameraRays rays(Camera{}, 16, 16);
    const TileBounds none{Span<const V3f>()};
    const VolumeInView sphere({V3f(0.0f), V3f(0.0f, 0.0f, 1.0f), 100.0f, 100.0f}, rays);
    const VolumeInView spheroid({V3f(0.0f), V3f(0.0f, 0.0f, 1.0f), 100.0f, 50.0f}, rays);
    for (std::uint32_t c = 0; c < TileBounds::kClusters; ++c) {
        CHECK(!sphere.overlaps(none.piece(c)));
        CHECK(!spheroid.overlaps(none.piece(c)));
    }
}

TEST_CASE("tiles: a tree finds the boxes that a list of them finds") {
    RandomStream random(8);
    const auto place = [&] { return V3f(random.next(), random.next(), random.next()) * 10.0f; };
    for (const std::size_t count : {0u, 1u, 16u, 17u, 300u, 5000u}) {
        std::vector<AlignedBox> boxes(count);
        for (AlignedBox& box : boxes) {
            const V3f center = place();
            const float size = 0.05f / (0.01f + random.next());
            box = {center - V3f(size), center + V3f(size)};
        }
        const BoxTree tree{Span<const AlignedBox>(boxes)};
        for (int i = 0; i < 200; ++i) {
            FrustumPiece piece;
            piece.add(place());
            if (i % 2 == 0) piece.add(place());
            std::vector<std::uint32_t> expected, found;
            for (std::uint32_t b = 0; b < count; ++b) {
                bool overlaps = true;
                for (int axis = 0; axis < 3; ++axis) {
                    overlaps = overlaps && boxes[b].low[axis] <= piece.high[axis] &&
                               boxes[b].high[axis] >= piece.low[axis];
                }
                if (overlaps) expected.push_back(b);
            }
            tree.for_overlapping(piece.box(), [&](std::uint32_t b) { found.push_back(b); });
            CHECK(found == expected);
        }
    }
}

TEST_CASE("tiles: boxes that only touch overlap") {
    const AlignedBox box{V3f(0.0f), V3f(1.0f)};
    const BoxTree tree({&box, 1});
    for (int axis = 0; axis < 3; ++axis) {
        for (const float place : {-0.001f, 0.0f, 1.0f, 1.001f}) {
            V3f point(0.5f);
            point[axis] = place;
            int found = 0;
            tree.for_overlapping({point, point}, [&](std::uint32_t) { ++found; });
            CHECK(found == (place >= 0.0f && place <= 1.0f ? 1 : 0));
        }
    }
}

TEST_CASE("tiles: what lies between the near and the far points of a tile is culled") {
    const CameraRays rays(Camera{}, 16, 16);
    const auto at_depth = [&](float x, float depth) {
        const Ray ray = rays.ray({8.0f + x, 8.0f}, {0.5f, 0.5f});
        return ray.origin + ray.direction * depth;
    };
    std::vector<V3f> points;
    for (const float depth : {1.0f, 1.2f, 2.8f, 3.0f}) {
        for (const float x : {-1.0f, 1.0f}) {
            points.push_back(rays.to_view(at_depth(x, depth) - rays.origin()));
        }
    }
    const TileBounds bounds{Span<const V3f>(points)};
    const auto overlapped = [&](float depth, float radius) {
        const VolumeInView sphere({at_depth(0.0f, depth), V3f(0.0f, 0.0f, 1.0f), radius, radius},
                                  rays);
        return 2 * sphere.overlaps(bounds.piece(0)) + sphere.overlaps(bounds.piece(1));
    };
    CHECK(overlapped(0.5f, 0.3f) == 0);
    CHECK(overlapped(1.1f, 0.3f) == 2);
    CHECK(overlapped(2.0f, 0.3f) == 0);
    CHECK(overlapped(2.9f, 0.3f) == 1);
    CHECK(overlapped(2.0f, 1.0f) == 3);
    CHECK(overlapped(3.5f, 0.3f) == 0);
}
