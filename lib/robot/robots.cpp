#include "robot/robots.hpp"

namespace rdm {
namespace {

// New ones stand at the end: hosts keep numbers.
const Robot* const kOwn[] = {
    &kShadowHand, &kAllegroHand, &kSchunkSvh, &kBarrettBh282, &kRobotiq3f,   &kFrankaPanda,
    &kAbbIrb4600, &kKinovaJaco2, &kKukaIiwa7, &kXarm6,        &kAbbCrb15000, &kUr5e,
    &kUr10e,      &kDrawer,      &kDoor,      &kScrewBottle,  &kScissors,    &kTap,
};

}  // namespace

int32_t Robots::num_own() {
  return static_cast<int32_t>(sizeof kOwn / sizeof kOwn[0]);
}
const Robot& Robots::own(int32_t index) {
  return *kOwn[index];
}
bool Robots::called(const Robot& robot, const char* name, int) {
  return same_name(robot.name, name) || (robot.alias && same_name(robot.alias, name));
}
void Robots::check(const Robot& robot) {
  check_robot(robot);
}

}  // namespace rdm
