#include "lights/groups/group_calibration.h"

namespace lightcull {

RangedScene ranged_scene(const LightGroups& groups, const Frame& frame) {
    return {frame, groups.ranged(), [&groups](std::size_t i, const LightBvhPoint& point) {
                const LightGroup& group = groups.groups[i];
                if (!(importance(group, point) > 0.0f)) return RangedScene::kOutOfReach;
                return group.ranged().distance(approach(point.position, group.position()));
            }};
}

}  // namespace lightcull
