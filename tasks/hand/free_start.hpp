// At the start hands and arms stand free: of the ground, of things, of the other hand and arm, of themselves.
//
// Only what choose_hand placed by itself is moved. A hand that is not the task's own and stands in something
// goes back the least way that frees it. Of the places and poses by which an arm brings its hand there, the
// one is taken with the largest
//   score min(gap, room) / room,   room = 4 cm,
// where gap is the least distance of the arm to anything but the robot it is of, and nothing of that robot
// touches; of two arms the pair with the largest sum. The first look, of which there is seldom need for
// another, is at the places that the hands have already.
#pragma once
#include "tasks/hand/hand_control.hpp"

namespace rdm {

// Moves bases and start poses in `scene`, which has all its bodies and statics. Where nothing is free, an arm
// stays as it was.
void free_start(const HandControlConfig& config, HandScene* scene);

}  // namespace rdm
