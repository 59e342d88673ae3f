// Renders and shows one triangle that shines at the camera: every library is linked and runs.

#include <lightcull/image/image.h>
#include <lightcull/render/renderer.h>
#ifdef WITH_GPU
#include <lightcull/gpu/vulkan_sampler.h>
#endif

#include <array>
#include <iostream>
#include <memory>
#include <utility>

int main() {
    const std::array<lightcull::float3, 3> positions{{{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}}};
    const std::array<std::uint32_t, 3> indices{0, 1, 2};
    const auto scene = std::make_shared<lightcull::Scene>();
    lightcull::Mesh mesh;
    mesh.material = scene->add_material({});
    mesh.positions = positions;
    mesh.indices = indices;
    mesh.emission.radiance = {1, 1, 1};
    scene->add_mesh(mesh);
    scene->set_camera({});
    scene->commit();

    lightcull::RenderSettings settings;
    settings.width = settings.height = 4;
    auto sampler = lightcull::make_scene_sampler("culled", *scene, settings);
#ifdef WITH_GPU
    sampler = lightcull::make_vulkan_sampler(std::move(sampler));
#endif
    lightcull::Renderer renderer(scene, settings, std::move(sampler));
    renderer.render_pass();
    const lightcull::Image image{4, 4, renderer.image()};
    std::cout << "white: " << lightcull::apply_view(image, "srgb").pixels[5].y << '\n';
}
