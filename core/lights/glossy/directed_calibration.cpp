#include "lights/glossy/directed_calibration.h"

#include "lights/glossy/directed_light.h"

namespace lightcull {

RangedScene directed_scene(const LightTable& table) {
    RangedScene scene = ranged_scene(table);
    scene.distance = [&table](std::size_t i, const Receiver& x) {
        const LightRecord& light = table.records[table.lit[i]];
        const Approach way = approach(x.position, light.center);
        return reaches(light, way, x) ? DirectedLight(light).distance(way)
                                      : RangedScene::kOutOfReach;
    };
    return scene;
}

}  // namespace lightcull
