// The rows of a .task file that make its scene: materials, robots, trees, bodies, what stands still. Each becomes a call of
// rdm_scene_*; what a reset draws and what later rows name is kept.
#pragma once
#include <memory>

#include "task_program.hpp"
#include "toml_text.hpp"

namespace rdm::import {

// Options, as numbers and texts that begin with '$'.
class SceneOptions : public Lookup {
 public:
  explicit SceneOptions(rdm_scene* scene) : scene_(scene) {}
  double number(const std::string& key) const override {
    double low = 0, high = 0, value = 0;
    if (rdm_scene_get_range(scene_, key.c_str(), &low, &high) == RDM_OK && low != high)
      refuse(RDM_ERROR_RANGE, "option %s is a range, %g..%g, but this value cannot be drawn",
             clean(key).c_str(), low, high);
    check(rdm_scene_get_number(scene_, key.c_str(), &value));
    return value;
  }
  std::string text(const std::string& key) const override {
    const char* text = nullptr;
    check(rdm_scene_get_text(scene_, key.c_str(), &text));
    return text;
  }
  Span range(const std::string& key) const {
    Span s{};
    if (rdm_scene_get_range(scene_, key.c_str(), &s.low, &s.high) == RDM_OK) return s;
    check(rdm_scene_get_number(scene_, key.c_str(), &s.low));
    s.high = s.low;
    return s;
  }

 private:
  static void check(rdm_result r) {
    if (r != RDM_OK) refuse(r, "%s", rdm_last_error());
  }
  rdm_scene* scene_;
};

inline void check(const Table& t, int line, rdm_result r) {
  if (r != RDM_OK) t.bad(r, line, "%s", rdm_last_error());
}

struct Part {  // a robot or a tree
  explicit Part(const Table& table) : t(table) {}
  Table t;
  std::unique_ptr<Draft> draft = std::make_unique<Draft>();
  std::string name;
  bool left = false;
  int32_t listed = -1;  // -1: the draft itself
  double p[3] = {}, q[4] = {0, 0, 0, 1};
  std::vector<double> start;  // by flange, of the first joints
};

class SceneText {
 public:
  SceneText(const toml::table& root, rdm_scene* scene, Program* p)
      : scene_(scene), p_(*p), options_(scene), top_{root, "", &options_} {}
  void read_scene();

 protected:
  // numbers
  Span span(const Table& t, const toml::node& n, const char* key) const;
  bool spans(const Table& t, const char* key, Span* out, size_t count) const;
  static bool drawn(const Span* s, size_t count);
  static void middle(const Span* s, size_t count, double* out);
  // q, or rpy: about x, then y, then z.
  void read_turn(const Table& t, double q[4]) const;
  // A pose whose numbers may be drawn; p and q are its middle.
  bool read_drawn(const Table& t, Span* ps, Span* turns, double* fixed, double* p, double* q) const;
  template <class T>
  T* take(const Table& t, T* rows, int32_t* count, int32_t most, const char* what) const {
    if (*count == most) t.bad(RDM_ERROR_RANGE, line_of(t.t), "there are more than %d %s", most, what);
    return rows + (*count)++;
  }
  // rows
  void materials();
  std::vector<std::string> texts(const Table& t, const char* key, size_t least, size_t most) const;
  void add_robot(const Table& t);
  void add_tree(const Table& t);
  void add_part(Part part, const char* kind);
  // Joints at which the arm's flange has a pose of the world.
  void reach(Part* part, int32_t arm);
  struct Shapes {
    std::deque<std::string> texts;
    std::deque<std::vector<double>> points;
    std::vector<rdm_shape_def> rows;
  };
  void read_shape(const Table& t, const std::string* name, Shapes* out) const;
  void place_shape(const Table& t, rdm_shape_def* s) const;
  // Where a body begins, drawn or not; `add` puts it into the scene.
  template <class F>
  void place_body(const Table& t, F&& add) {
    Draw d{};
    rdm_pose pose{};
    bool moves = read_drawn(t, d.p, d.turn, d.q, pose.p, pose.q);
    moves = spans(t, "v", d.v, 3) || moves;
    moves = spans(t, "w", d.w, 3) || moves;
    d.apart = t.flag("apart", true);
    check(t, line_of(t.t), add(pose, &d.body));
    if (moves) *take(t, p_.draws, &p_.num_draws, kMostDraws, "bodies with a range in p, rpy, v or w") = d;
  }
  // One of the catalogue, or the host's: shapes, mass and friction are its own.
  void add_object(const Table& t);
  void add_body(const Table& t);
  void add_static(const Table& t);
  int32_t find(const Table& t, const char* key, int32_t part, const std::string& name) const;

  rdm_scene* scene_;
  Program& p_;
  SceneOptions options_;
  Table top_;
  std::vector<Part> parts_;
  std::vector<std::string> names_, joint_names_;  // for hints
  bool compensated_ = false;
};

}  // namespace rdm::import
