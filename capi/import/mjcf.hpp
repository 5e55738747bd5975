// The reader of MJCF; its parts stand in four files: mjcf.cpp (values, classes, the file's sections),
// mjcf_bodies.cpp (bodies, joints, masses), mjcf_geoms.cpp (shapes), mjcf_drives.cpp (what couples and drives).
#pragma once
#include <deque>
#include <set>

#include "fill.hpp"
#include "meshes.hpp"
#include "mjcf_table.hpp"

namespace rdm::import {

struct Compiler {
  bool degrees = true, autolimits = true, balance = false, strip = false, exact = false, fit_box = false;
  bool friction = true, damping = true;  // flags of <option>
  std::string sequence = "xyz", meshes, inertia_from = "auto";
  double least_mass = 0, least_moment = 0, total_mass = -1;
  int first_group = 0, last_group = 5;  // of the geoms that have mass
};

// A mesh of <asset> in its own frame.
struct MeshIn {
  Primitive hull;  // the smallest around it
  Mass mass;       // at density 1; 0: it encloses nothing
  Mass surface;    // the same of its surface alone (shellinertia of a geom)
  Pose X;          // of its principal axes, the longest last
  V3 box;          // half sizes of the box of the same moments
  V3 low, high;    // its corners' bounds along the principal axes
};

struct Tendon {
  const Element* element;
  std::vector<std::pair<std::string, double>> joints;  // and their coefficients
};

class MjcfReader {
 public:
  MjcfReader(const Element& file, const Options& given, Draft* draft)
      : mujoco(file), options(given), out(draft), mesh_options(given) {}
  void read();
  Model model;

 private:
  using Values = std::map<std::string, const Attribute*>;  // of one kind of element in one class
  struct Class {
    const Class* parent = nullptr;         // what a class does not say is said by this one
    std::map<std::string, Values> values;  // by kind
  };

  const Element& mujoco;
  const Options& options;
  Draft* out;
  Options mesh_options;  // with the folder of the compiler
  Meshes meshes{mesh_options, out};
  Compiler compiler;
  std::deque<Class> class_rows;                  // one for each <default>
  std::map<std::string, const Class*> classes;   // the last row of each name
  std::map<std::string, const Element*> assets;  // meshes by name
  std::map<const Element*, MeshIn> read_meshes;
  std::vector<std::string> order;            // joints as qpos has them, "" of a free joint
  std::map<std::string, JointIn*> joint_by;  // after the bodies are read
  std::map<std::string, Tendon> tendons;
  std::vector<std::string> tendon_order;
  std::set<std::string> driven;  // joints with an actuator of their own

  // ---- values: of the element, else of its class ----
  const std::string* value(const Element& e, const char* key, const std::string& childclass,
                           const char* kind = nullptr) const;
  double number_of(const Element& e, const char* key, const std::string& c, double otherwise,
                   const char* kind = nullptr) const;
  bool flag(const Element& e, const char* key, const std::string& text) const;
  // Whether a range holds: `limited` says so, or it is auto and the range is not "0 0". Refused, as in MuJoCo,
  // where the compiler's autolimits is false and nothing else says it.
  bool limited(const Element& e, const char* key, const std::string* limited, const std::string* range) const;
  double angle(double x) const { return compiler.degrees ? x * M_PI / 180 : x; }
  Turn turn_at(const Element& e, const std::string& c) const;
  Pose pose_at(const Element& e, const std::string& c = "") const;

  // ---- sections ----
  void read_classes(const Element& e, const Class* parent, bool top);
  void read_compiler();
  void read_assets();
  void read_excluded();
  void read_keyframe();

  // ---- bodies ----
  void add_joint(const Element& e, const Pose& frame, const std::string& c, BodyIn* body);
  void drop_free(const Element& e);
  Mass inertial(const Element& e, const BodyIn& body, bool moves);
  void bound(const Element& e, const std::string& name, Mass* m);
  void read_parts(const Element& e, const Pose& frame, const std::string& c, int self, Mass* from_geoms,
                  int depth);
  void add_body(const Element& e, int parent, const Pose& frame, const std::string& c, int depth);
  bool moves(const Element& e, const std::string& c) const;
  bool drops_mocap(const Element& e, const std::string& c) const;
  void add_world(const Element& e);
  void read_worlds();
  void scale_masses();

  // ---- shapes ----
  void add_geom(const Element& e, const Pose& frame, const std::string& c, BodyIn* body, Mass* from_geoms);
  const MeshIn* mesh_in(const Element& geom, const std::string& name);
  const MeshIn* mesh_of(const Element& asset, const Element& geom);
  Primitive primitive(const Element& e, const std::string& kind, const std::string& c, const Pose& X,
                      const Pose& frame) const;
  Primitive fitted(const Element& e, const std::string& kind, const std::string& c, const MeshIn& mesh) const;

  // ---- what couples and drives ----
  bool elsewhere(const Element& e, const std::string& joint) const;
  void find_driven();
  void read_tendons();
  void read_equalities();
  void read_equality(const Element& e);
  void refuse_limited(const Element& spatial) const;
  void narrow(const Element& e, const std::string& joint, double one, double other);
  void read_tendon_limits();
  void couple_joints(const Element& e, const std::string& follower, double cf, const std::string& leader,
                     double cl, double length, double slack);
  void lead_by_driven();
  void read_actuators();
  void read_actuator(const Element& e);
  bool is_mocap(const std::string& body) const;
  bool stands(const std::string& body) const;
  bool ties_nothing(const Element& e) const;
  void note_left_out(const Element& e, const char* why);
};

std::string in_file(const Element& e);  // " (in b.xml)"

}  // namespace rdm::import
