#include "lights/groups/group_calibration.h"

namespace lightcull {

RangedScene ranged_scene(const LightGroups& groups, const Frame& frame) {
    return {frame, groups.ranged(), [&groups](std::size_t i, const Receiver& receiver) {
                const LightGroup& group = groups.groups[i];
                if (!(importance(group, receiver) > 0.0f)) return RangedScene::kOutOfReach;
                return group.ranged().distance(approach(receiver.position, group.position()));
            }};
}

}  // namespace lightcull
