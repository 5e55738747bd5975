// Cameras that ride on robots.
#pragma once
#include "physics/world.hpp"
#include "sense/render/camera.hpp"

namespace rdm {

// The camera where it is now, of the world: its eye, target and up brought there by the frame of its mount.
Camera placed(const Camera& camera, const World& world);

}  // namespace rdm
