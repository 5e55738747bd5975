// A robot as files have it: bodies in a tree, each with any number of joints (none: fixed), shapes, frames
// with names. `build` makes the rows of an rdm_robot_def of it: fixed bodies merged, links in depth-first
// order, gains, pairs, roles.
#pragma once
#include <map>
#include <utility>

#include "geometry.hpp"
#include "import.hpp"
#include "shapes.hpp"
#include "xml.hpp"

namespace rdm::import {

// Damping above this is how files say that a joint is fixed. Between the largest allowed gain and this, damping is
// reduced to that gain, with a note.
inline constexpr double kMostDamping = 1e30;

struct JointIn {
  std::string name;
  const Element* element = nullptr;
  bool slides = false;
  V3 at, axis{0, 0, 1};         // in the body's frame
  double lower = 0, upper = 0;  // rad, m
  double turned = 0;            // by which the body's pose in the file is ahead of the joint's 0
  double velocity = 0, armature = 0, friction = 0, damping = 0;
  double effort = -1, kp = -1, kd = -1;  // -1: not said
  double most_effort = -1;               // of all that drives it; -1: no bound
  double damping_ratio = 0;              // of its drive, against the inertia that it feels; beside kd
  bool has_command = false, driven = false;
  double command_low = 0, command_high = 0;
};
struct ShapeIn {
  std::string name;
  const Element* element = nullptr;
  Primitive shape;  // X in the body's frame
  int contype = 1, conaffinity = 1;
  std::array<uint8_t, 3> color{178, 178, 184};
};
struct BodyIn {
  std::string name;
  const Element* element = nullptr;
  int parent = -1;  // an earlier one; the first body is the root
  Pose X;           // in the parent's frame with the joints at their 0
  std::vector<JointIn> joints;
  Mass mass;  // in the body's frame
  std::vector<ShapeIn> shapes;
};
struct FrameIn {
  std::string name;
  int body = 0;
  Pose X;
};
struct CouplingIn {  // q_follower = ratio q_leader + offset
  std::string follower, leader;
  double ratio = 1, offset = 0, slack = 0;
  const Element* element = nullptr;
};

struct Model {
  std::string name;
  std::vector<BodyIn> bodies;
  std::vector<FrameIn> frames;
  std::vector<CouplingIn> couplings;
  std::vector<std::pair<std::string, std::string>>
      excluded;                        // names of bodies whose shapes pass through each other
  std::map<std::string, double> home;  // by joint
  const char* massless_hint = "";      // ends the refusal of a body that moves and has no mass
};

// How far a joint without an end goes to either side, rad or m.
inline double most_of(const Options& options, bool slides) {
  return slides && options.slide_range > 0 ? options.slide_range : 2 * M_PI;
}

// Where a body or a frame of the file went: `row` of links (RDM_LINK_ROOT), its pose there.
struct Place {
  int32_t row = RDM_LINK_ROOT;
  Pose X;
};
using Places = std::map<std::string, Place>;  // by name in the file, and by the name it got

// Refuses a mass that is not above 0, moments that are negative or break the triangle rule; `mend` adds to
// each what they lack, with a note. Moments that are all 0 are a point's. `what` is the link, for the text.
void check_mass(const Element& e, const std::string& what, bool mend, Mass* m, Draft* out);

void build(const Model& model, const Options& options, Draft* out);
// Kind, palm, fingers, mount, flange and poses, as far as options do not say them.
void give_roles(const Places& places, const Options& options, Draft* out);

// Poses of the links in the root frame at joints q [num_links]; of row `row` with RDM_LINK_ROOT.
std::vector<Pose> link_poses(const Draft& d, const std::vector<double>& q);
inline Pose pose_of(const std::vector<Pose>& poses, int32_t row) {
  return row < 0 ? Pose{} : poses[static_cast<size_t>(row)];
}
Primitive primitive_of(const rdm_robot_shape& s);
// Joints at the start: home, else 0 or the limit nearest to it.
std::vector<double> home_of(const Draft& d);
bool is_below(const Draft& d, int32_t row, int32_t ancestor);  // or the same
// Inertia about each joint's axis of what hangs on it, armature included, with the joints at q.
std::vector<double> felt_inertia(const Draft& d, const std::vector<double>& q);

}  // namespace rdm::import
