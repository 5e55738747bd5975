// An episode as binary glTF 2.0: a mesh for each shape, and its way as an animation of its node.
#pragma once
#include <string>

#include "play/playback.hpp"

namespace tool {

// The bytes of a .glb file. A root node turns our z-up world to glTF's y-up one; its children are the shapes,
// with their names, and the task's cameras. Frame k stands at k control_dt seconds. Rotations are normalised
// 16-bit integers, everything else is float32. Planes become squares about what the episode shows.
std::string glb_bytes(const Playback& playback);

}  // namespace tool
