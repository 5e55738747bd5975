// A map of what stands about in a scene at its start, as depth cameras would show it to a robot before it
// moves.
#pragma once
#include "physics/model/scene.hpp"
#include "sense/map/occupancy.hpp"
#include "sense/render/camera.hpp"

namespace rdm {

// Puts a scan by each camera, pictures of side x side rays, into the map. They see the bodies listed, at
// their start poses, and what is at rest if `statics`; planes and hands are left out, as a robot leaves out
// itself.
void scan_scene(const Scene& scene, bool statics, const int32_t* bodies, int32_t num_bodies,
                const Camera* cameras, int32_t num_cameras, int32_t side, Occupancy* map);

}  // namespace rdm
