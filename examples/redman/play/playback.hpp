// An episode as it looked, frame by frame: what a viewer needs of it when the pool is gone.
#pragma once
#include <deque>
#include <memory>
#include <redman/redman.hpp>
#include <string>
#include <vector>

namespace tool {

struct Body {
  std::string name;            // "right.ff_distal"
  int32_t kind = 0;            // RDM_SHAPE_SPHERE ... RDM_SHAPE_HULL
  float size[3] = {};          // as in rdm_shape_info
  uint8_t color[3] = {};       // red, green, blue
  std::vector<float> corners;  // [n][3] of a hull, own frame, m
};

struct CostCurve {
  std::string name, help;
  double limit = -1;  // on the sum over an episode, < 0: none
};

struct Playback {
  std::string task, summary, actor;  // actor: the word of --policy
  uint64_t seed = 0;
  double control_dt = 0;  // s between frames
  int32_t first_step = 0;
  std::vector<Body> bodies;
  std::vector<rdm_camera_info> cameras;
  std::vector<CostCurve> costs;
  std::shared_ptr<std::deque<std::string>> names;  // of cameras, where no task holds them

  size_t frames = 0;
  std::vector<float> poses;           // [frames][bodies][7] position (m), quaternion (x, y, z, w)
  std::vector<float> reward;          // [frames] of the step that led to the frame
  std::vector<float> cost;            // [frames][costs] likewise
  std::vector<float> episode_return;  // [frames] sum up to the frame
  std::vector<float> episode_cost;    // [frames][costs] likewise
  std::vector<uint8_t> success;       // [frames]
  std::string shield;                 // the word of --shield, "" none
  std::vector<float>
      stepped_in;  // [frames] 1: the shield did, in the step that led to the frame; empty: none
  std::vector<rdm_contact> contacts;  // of all frames
  std::vector<size_t> contacts_end;   // [frames] into contacts
  bool terminated = false;            // a fall ended it

  const float* pose(size_t frame, size_t body) const { return &poses[(frame * bodies.size() + body) * 7]; }
  // Its pose differs in some frame.
  bool moves(size_t body) const;
};

// What stays the same in world 0 of a pool. limits [cost_dim], < 0: none.
Playback begin_playback(const redman::Pool& pool, const std::vector<double>& limits);
// World 0 as it stands now.
void add_frame(Playback& playback, const redman::Pool& pool);

}  // namespace tool
