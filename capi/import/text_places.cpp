// Places that terms name: of the world, bodies, links, shapes, a hand's palm and fingertips.
#include <algorithm>
#include <cmath>

#include "geometry.hpp"
#include "text_terms.hpp"

namespace rdm::import {

Place TermText::place(const Table& t, const char* key) const {
  const toml::node& n = t.need(key);
  Place out{On::kWorld, 0, {0, 0, 0}, {0, 0, 0, 1}};
  if (n.is_array()) {
    const auto p = t.list(n, key, 3, 3);
    std::copy(p.begin(), p.end(), out.p);
    return out;
  }
  const toml::table* inner = n.as_table();
  if (!inner) return named_place(t, n, key, t.as_text(n, key));
  const Table in{*inner, t.what + ": " + key, t.lookup};
  in.only({"on", "p", "q", "rpy"});
  out = named_place(in, in.need("on"), "on", in.as_text(in.need("on"), "on"));
  double p[3] = {}, q[4] = {0, 0, 0, 1}, arm[3];
  in.numbers("p", p, 3);
  read_turn(in, q);
  rotate(out.q, p, arm);
  for (int k = 0; k < 3; ++k) out.p[k] += arm[k];
  multiply(out.q, q, out.q);
  return out;
}

Place TermText::named_place(const Table& t, const toml::node& n, const char* key,
                            const std::string& name) const {
  Place out{On::kWorld, 0, {0, 0, 0}, {0, 0, 0, 1}};
  if (name == "world") return out;
  for (size_t i = 0; i < parts_.size(); ++i) {
    const Part& part = parts_[i];
    if (name.compare(0, part.name.size() + 1, part.name + '.') == 0)
      if (place_on_hand(i, name.substr(part.name.size() + 1), &out)) return out;
  }
  static constexpr struct {
    int32_t part;
    On on;
  } kFound[] = {{RDM_SCENE_BODY, On::kBody},
                {RDM_SCENE_ROBOT, On::kBase},
                {RDM_SCENE_LINK, On::kLink},
                {RDM_SCENE_SHAPE, On::kShape}};
  for (const auto& k : kFound)
    if (rdm_scene_find(scene_, k.part, name.c_str(), &out.index) == RDM_OK) {
      out.on = k.on;
      return out;
    }
  t.bad(RDM_ERROR_NOT_FOUND, line_of(n), "%s: there is no body, robot, link or shape %s%s", key,
        clean(name).c_str(), nearest_hint(name, names_).c_str());
}

void TermText::mirrored(const Part& part, const double in[3], double out[3]) {
  std::copy_n(in, 3, out);
  if (part.left) out[part.draft->def.mirror] *= -1;
}

bool TermText::place_on_hand(size_t index, const std::string& what, Place* out) const {
  const Part& part = parts_[index];
  const rdm_robot_def& d = part.draft->def;
  const auto on = [&](int32_t link) {
    out->on = link == RDM_LINK_ROOT ? On::kBase : On::kLink;
    out->index = link == RDM_LINK_ROOT ? static_cast<int32_t>(index) : first_joint(index) + link;
  };
  if (what == "palm" && d.palm_link != RDM_LINK_NONE) {  // y into it, z as the fingers point
    on(d.palm_link);
    mirrored(part, d.hold_p, out->p);
    double y[3], z[3];
    mirrored(part, d.palm_normal, y);
    mirrored(part, d.palm_fingers, z);
    for (double& c : y) c = -c;
    turn_to(y, z, out->q);
    return true;
  }
  for (const rdm_robot_finger& f : part.draft->fingers)
    if (what == f.name) {
      on(f.tip);
      mirrored(part, f.p_tip, out->p);
      return true;
    }
  return false;
}

int32_t TermText::first_joint(size_t index) const {
  int32_t first = 0;
  for (size_t i = 0; i < index; ++i) first += static_cast<int32_t>(parts_[i].draft->links.size());
  return first;
}

void TermText::turn_to(const double y[3], const double z[3], double q[4]) {
  const V3 columns[3] = {cross(vec(y), vec(z)), vec(y), vec(z)};
  M3 m;
  for (size_t i = 0; i < 3; ++i)
    for (size_t k = 0; k < 3; ++k) m[i][k] = columns[k][static_cast<int>(i)];
  put(import::turn_of(m), q);
}

}  // namespace rdm::import
