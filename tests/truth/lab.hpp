// A laboratory on the public header alone: a scene of plain structs becomes a task of its own
// (rdm_task_create, rdm_scene_*) and a pool of one world; after each control step all that can be seen of
// it is copied out. SI units, radians; quaternions (x, y, z, w), as in redman.h.
#pragma once
#ifndef RDM_EXPERIMENTAL
#define RDM_EXPERIMENTAL
#endif
#include <redman/redman.h>

#include <array>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

namespace truth {

using V3 = std::array<double, 3>;
using V4 = std::array<double, 4>;  // x, y, z, w
inline constexpr double kG = 9.81, kPi = 3.14159265358979323846;
inline constexpr V4 kNoTurn = {0, 0, 0, 1};

V3 operator+(const V3& a, const V3& b);
V3 operator-(const V3& a, const V3& b);
V3 operator*(double s, const V3& a);
double dot(const V3& a, const V3& b);
V3 cross(const V3& a, const V3& b);
double norm(const V3& a);
V3 rotate(const V4& q, const V3& a);    // from the body's axes to the world's
V3 unrotate(const V4& q, const V3& a);  // and back
V4 turn(const V3& axis, double angle);  // axis of any length

struct Shape {
  int32_t kind = RDM_SHAPE_SPHERE;
  V3 size{};
  V3 p{};
  V4 q = kNoTurn;
  std::string name;  // "": that of the body
  std::vector<V3> points;
};
Shape sphere(double r);
Shape box(double x, double y, double z);  // half sizes
Shape capsule(double r, double half, const V4& q = kNoTurn);
Shape cylinder(double r, double half, const V4& q = kNoTurn);
Shape hull(std::vector<V3> points);
Shape block(double x, double y, double z);  // a box as a hull of its corners
Shape plane();

struct Body {
  std::vector<Shape> shapes;
  double mass = 1;
  V3 p{};
  V4 q = kNoTurn;
  V3 v{};
  V3 w{};
  V3 moment{};  // principal; all 0: of the shapes
};

struct Link {
  int32_t parent = RDM_LINK_ROOT;
  int32_t kind = RDM_JOINT_REVOLUTE;
  V3 p{};
  V3 axis = {0, 1, 0};
  double lower = -1e3, upper = 1e3;
  double kp = 0, kd = 0, effort = 0, armature = 0, friction = 0;
  double mass = 1;
  V3 com{};
  V3 moment{};  // about com, principal
};

struct Coupling {
  int32_t link = 1, other = 0;
  double ratio = 1;
};

struct Robot {
  std::string known;  // a robot of the list in the place of `links`; "": own ones
  std::vector<Link> links;
  std::vector<std::pair<int32_t, Shape>> shapes;  // link and shape
  std::vector<Coupling> couplings;
  V3 p{};
  V4 q = kNoTurn;
  bool free_base = false, gravity = true;
  double base_damping = 0;
  double root_mass = 0;
  V3 root_com{}, root_moment{};
  V3 v{}, w{};
  std::vector<double> q0, qd0;  // joints at the start
};

class Lab;
struct Scene {
  std::vector<Body> bodies;
  std::vector<Robot> robots;
  std::vector<Shape> statics;
  V3 gravity = {0, 0, -kG};
  double friction = 1;  // of all on all
  bool feedforward = false;
  std::string settings;                       // lines key=value
  std::function<void(rdm_scene*)> materials;  // what "m" is beside its friction
  std::function<void(const Lab&, rdm_world*)> control;
};

// A call of the library that failed, with its text.
struct Failure : std::runtime_error {
  using std::runtime_error::runtime_error;
};
void check(rdm_result r);

class Lab {
 public:
  explicit Lab(Scene scene);
  ~Lab();
  Lab(const Lab&) = delete;
  Lab& operator=(const Lab&) = delete;

  void reset();          // to the starts that `scene` has now
  void step(int n = 1);  // control steps; a Failure where the world diverged
  double time() const { return static_cast<double>(steps_) * control_dt; }

  Scene scene;  // starts of bodies may be changed before a reset
  std::vector<rdm_motion> bodies, links, bases;
  std::vector<double> q, qd, torque;
  std::vector<rdm_contact> contacts;
  double control_dt = 0;  // s
  uint32_t status = 0;    // of all steps since the reset

  V3 p(size_t body = 0) const;
  V3 v(size_t body = 0) const;
  V3 w(size_t body = 0) const;
  V4 turned(size_t body = 0) const;
  V3 force_on(int32_t shape) const;  // N, sum of the contacts' of one shape
  double deepest() const;            // m, 0 without contacts

 private:
  struct Calls;
  rdm_result build(rdm_scene* scene);
  void set(rdm_world* world);
  void look(const rdm_world* world);
  std::string name_;
  int32_t task_ = -1;
  rdm_pool* pool_ = nullptr;
  const uint32_t* status_row_ = nullptr;
  std::string error_;
  int64_t steps_ = 0;
  size_t joints_ = 0;
};

V3 vec(const double* a);
V3 vec(const float* a);

}  // namespace truth
