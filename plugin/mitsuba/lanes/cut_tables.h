#pragma once

#include <lightcull/triangle_cuts.h>

#include <drjit/array.h>
#include <drjit/dynamic.h>
#include <drjit/jit.h>
#include <drjit/util.h>
#include <drjit/while_loop.h>
#include <mitsuba/core/vector.h>
#include <mitsuba/core/warp.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "lanes/cut_walk.h"
#include "scene/triangle_places.h"

namespace mitsuba::culling {

namespace dr = drjit;

/// The places on lights that are triangles, or parts of triangles that are cut, as Dr.Jit arrays:
/// TrianglePlaces for kernels. Nothing is derived through them.
template <typename Float_>
class CutTables {
  public:
    using Float = dr::detached_t<Float_>;
    using Double = dr::float64_array_t<Float>;
    using UInt32 = dr::uint32_array_t<Float>;
    using Mask = dr::mask_t<Float>;
    using Point2f = Point<Float, 2>;

    /// A place on a light: barycentric coordinates in its triangle, and density by area (1/m^2).
    struct Place {
        Point<Float_, 2> uv;
        Float_ density;
    };
    struct Found {
        dr::uint32_array_t<Float_> light;
        Float_ density;
    };

    CutTables() = default;
    CutTables(const TrianglePlaces& places, std::uint32_t light_count) {
        if (!places.has_parts()) return;
        has_parts_ = true;
        Loader loader(places);
        for (std::uint32_t light = 0; light < light_count; ++light) loader.add_light(light);
        loader.add_links();
        piece_count_ = static_cast<std::uint32_t>(loader.sums.size());
        has_choice_ = piece_count_ > light_count;
        pieces_ = dr::load<Float>(loader.pieces.data(), loader.pieces.size());
        sums_ = dr::load<Double>(loader.sums.data(), loader.sums.size());
        is_linear_ = loader.is_linear;
        weights_ = dr::load<Float>(loader.weights.data(), loader.weights.size());
        links_ = dr::load<UInt32>(loader.links.data(), loader.links.size());
        roots_ = dr::load<UInt32>(loader.roots.data(), loader.roots.size());
        dr::sync_thread();  // the vectors must live until they are copied
    }

    /// Whether any triangle is cut. Else no other function may be called.
    bool has_parts() const { return has_parts_; }
    /// Whether any light has several pieces, of which draw() chooses one.
    bool has_choice() const { return has_choice_; }

    /// Draws a place on the lights, which are triangles: first a piece by two numbers in [0, 1), of
    ///     /// which the second gives digits that the first does not have, then a place by two
    ///     others.
    Place draw(const dr::uint32_array_t<Float_>& light, const Float_& piece_1,
               const Float_& piece_2, const Point<Float_, 2>& random,
               const dr::mask_t<Float_>& active) const {
        const Mask wanted = dr::detach<false>(active);
        UInt32 piece = dr::detach<false>(light);
        if (has_choice_) {
            constexpr double kLastDigit = 0x1p-24;
            const Double target =
                Double(piece) + dr::minimum(Double(dr::detach<false>(piece_1)) +
                                                kLastDigit * Double(dr::detach<false>(piece_2)),
                                            1.0 - kLastDigit);
            // The first piece that begins after it is the next one.
            piece =
                dr::binary_search<UInt32>(
                    1, piece_count_,
                    [&](const UInt32& i) {
                        return dr::gather<Double>(sums_, i, wanted && i < piece_count_) <= target;
                    }) -
                1u;
        }
        const auto words = dr::gather<dr::Array<Float, kWords>>(pieces_, piece, wanted);
        Point2f in_piece(dr::detach<false>(random.x()), dr::detach<false>(random.y()));
        Float density = words[6];
        if (is_linear_) {
            const auto w = dr::gather<dr::Array<Float, kWeights>>(weights_, piece, wanted);
            const WeightsInNode<Float> there =
                draw_linear<Float>({w[0], w[1], w[2]}, in_piece.x(), in_piece.y(), kSelect);
            in_piece = Point2f(there.of[1], there.of[2]);
            density *= linear(w, there);
        } else {
            in_piece = warp::square_to_uniform_triangle(in_piece);
        }
        const Float u = in_piece.x(), v = in_piece.y();
        const Point2f place(dr::fmadd(words[2], u, dr::fmadd(words[4], v, words[0])),
                            dr::fmadd(words[3], u, dr::fmadd(words[5], v, words[1])));
        return {{place.x(), place.y()}, density};
    }

    /// Finds places of triangles again: the light that each belongs to, and the density with which
    /// it is drawn on that, 0 where it is not. `light` is the triangle's, or its first part's.
    Found find(const dr::uint32_array_t<Float_>& light, const Point<Float_, 2>& uv,
               const dr::mask_t<Float_>& active) const {
        const Mask wanted = dr::detach<false>(active);
        const UInt32 whole = dr::detach<false>(light);
        UInt32 link = dr::gather<UInt32>(roots_, whole, wanted);
        const Float u = dr::detach<false>(uv.x()), v = dr::detach<false>(uv.y());
        Float w0 = 1.0f - u - v, w1 = u, w2 = v;
        dr::tie(link, w0, w1, w2) = dr::while_loop(
            dr::make_tuple(link, w0, w1, w2),
            [wanted](const UInt32& link, const Float&, const Float&, const Float&) {
                return wanted && (link & kLeaf) == 0u;
            },
            [this](UInt32& link, Float& w0, Float& w1, Float& w2) {
                WeightsInNode<Float> weights{{w0, w1, w2}};
                const Mask second = weights.step(UInt32(link & 3u), kSelect);
                w0 = weights.of[0];
                w1 = weights.of[1];
                w2 = weights.of[2];
                link = dr::gather<UInt32>(
                    links_, (link >> 2u) + dr::select(second, UInt32(1), UInt32(0)), Mask(true));
            },
            "lightcull: to a piece");
        const UInt32 piece = link & ~kLeaf;
        const Mask is_there = wanted && piece != kNothing;
        const auto words = dr::gather<dr::Array<Float, kWords>>(pieces_, piece, is_there);
        Float density = words[6];
        if (is_linear_) {
            const auto w = dr::gather<dr::Array<Float, kWeights>>(weights_, piece, is_there);
            density *= linear(w, {{w0, w1, w2}});
        }
        return {dr::select(is_there, dr::reinterpret_array<UInt32>(words[7]), whole),
                dr::select(is_there, density, Float(0.0f))};
    }

  private:
    /// Of a piece: its first corner, the edges from there to the others, density and light.
    static constexpr std::size_t kWords = 8;
    /// Of a piece: the densities at its corners, with a sum of 1, and nothing.
    static constexpr std::size_t kWeights = 4;
    /// A link is a node: kLeaf | piece, or first child << 2 | edge.
    static constexpr std::uint32_t kLeaf = 0x80000000u, kNothing = 0x7fffffffu;

    static constexpr auto kSelect = [](const auto& mask, const auto& a, const auto& b) {
        return dr::select(mask, a, b);
    };

    /// The density at a place, over the mean of the piece.
    static Float linear(const dr::Array<Float, kWeights>& weights,
                        const WeightsInNode<Float>& place) {
        return 3.0f *
               (weights[0] * place.of[0] + weights[1] * place.of[1] + weights[2] * place.of[2]);
    }

    /// Makes the tables.
    struct Loader {
        using Cuts = ::lightcull::TriangleCuts;

        explicit Loader(const TrianglePlaces& places)
            : places(places), piece_of_node(places.cuts().nodes().size(), kNothing) {}

        void add_light(std::uint32_t light) {
            const std::uint32_t part = places.part(light);
            sum = static_cast<double>(light);
            this->light = light;
            roots.push_back(kLeaf | static_cast<std::uint32_t>(sums.size()));
            if (part == TrianglePlaces::kNone) {
                add_piece({}, {1.0f, 1.0f, 1.0f}, 1.0);
            } else {
                const Cuts::Part& of = places.cuts().parts()[part];
                add_pieces(of.node, of.corners, 1.0);
            }
        }

        void add_pieces(std::uint32_t node, const ::lightcull::SubTriangle& corners, double prob) {
            const Cuts::Node& of = places.cuts().nodes()[node];
            if (of.first_child == 0) {
                piece_of_node[node] = static_cast<std::uint32_t>(sums.size());
                add_piece(corners, {of.weights[0], of.weights[1], of.weights[2]}, prob);
                return;
            }
            const auto share = static_cast<double>(of.share);
            for (const bool second : {false, true}) {
                const double of_half = prob * (second ? 1.0 - share : share);
                // What emits nothing is no piece.
                if (of_half > 0.0) {
                    add_pieces(of.first_child + (second ? 1 : 0),
                               ::lightcull::half_of(corners, of.edge, second), of_half);
                }
            }
        }

        void add_piece(const ::lightcull::SubTriangle& piece, const std::array<float, 3>& at,
                       double prob) {
            is_linear |= at[0] != at[1] || at[1] != at[2];
            const float sum_of_weights = at[0] + at[1] + at[2];
            for (const float weight : at) weights.push_back(weight / sum_of_weights);
            weights.push_back(0.0f);
            const auto [a, b, c] = piece.corners;
            const double area = static_cast<double>(::lightcull::area_share(piece)) *
                                static_cast<double>(places.area(light));
            float name = 0.0f;
            std::memcpy(&name, &light, sizeof name);
            pieces.insert(pieces.end(), {a.x, a.y, b.x - a.x, b.y - a.y, c.x - a.x, c.y - a.y,
                                         static_cast<float>(prob / area), name});
            sums.push_back(sum);
            sum += prob;
        }

        void add_links() {
            const auto nodes = places.cuts().nodes();
            for (std::uint32_t i = 0; i < nodes.size(); ++i) {
                links.push_back(nodes[i].first_child != 0
                                    ? nodes[i].first_child << 2 | nodes[i].edge
                                    : kLeaf | piece_of_node[i]);
            }
            for (std::uint32_t i = 0; i < roots.size(); ++i) {
                const std::uint32_t triangle = places.triangle(i);
                if (triangle != TrianglePlaces::kNone) roots[i] = links[triangle];
            }
        }

        const TrianglePlaces& places;
        std::vector<std::uint32_t> piece_of_node;
        std::uint32_t light = 0;
        double sum = 0.0;
        bool is_linear = false;
        std::vector<float> pieces, weights;
        std::vector<double> sums;
        std::vector<std::uint32_t> links, roots;
    };

    bool has_parts_ = false, has_choice_ = false;
    bool is_linear_ = false;  ///< the density is not even on all pieces
    std::uint32_t piece_count_ = 0;
    Float pieces_, weights_;
    Double sums_;  ///< number of the light, and what its pieces before one have
    UInt32 links_, roots_;
};

}  // namespace mitsuba::culling
