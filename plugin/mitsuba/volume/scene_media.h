#pragma once

#include <mitsuba/render/bsdf.h>
#include <mitsuba/render/medium.h>
#include <mitsuba/render/scene.h>

namespace mitsuba::culling {

/// Which kinds of media and surfaces there are in a scene, so that kernels need not provide for
/// others.
struct SceneMedia {
    bool homogeneous = false;
    bool heterogeneous = false;
    bool see_through = false;  ///< a surface lets light straight through

    template <typename Scene>
    explicit SceneMedia(const Scene* scene) {
        for (const auto& shape : scene->shapes()) {
            if (shape->is_instance()) {
                // What it is an instance of does not show.
                homogeneous = heterogeneous = see_through = true;
                continue;
            }
            add(shape->interior_medium());
            add(shape->exterior_medium());
            if (shape->bsdf() && has_flag(shape->bsdf()->flags(), BSDFFlags::Null)) {
                see_through = true;
            }
        }
    }

    /// Adds a medium that a camera is in; null: it is in none.
    template <typename Medium>
    void add(const Medium* medium) {
        if (medium) (medium->is_homogeneous() ? homogeneous : heterogeneous) = true;
    }
};

}  // namespace mitsuba::culling
