// Infers what URDF and MJCF do not say: which links are palm, fingers and tips, and where an arm ends.
//
// Rows without a child are ends; the stem is the chain that all of them hang on. One end, or a stem of at least four
// joints, makes an arm, whose flange is the last link of the stem. Anything else is a hand: the palm is the link at
// which all chains part, each end is a fingertip, and a finger begins after the last fork above its tip. The thumb
// is the finger of that name, or the one that differs most from the others in place and direction.
#include <algorithm>
#include <cctype>

#include "base/chars.hpp"
#include "model.hpp"

namespace rdm::import {
namespace {

constexpr int kLongStem = 4;  // joints before the first fork, of an arm

struct Guess {
  const Places& places;
  const Options& options;
  Draft* out;
  std::vector<int32_t> ends;
  std::vector<Pose> poses;       // with the joints at 0
  int32_t fork = RDM_LINK_ROOT;  // the last row that all ends hang on
  int32_t stem = 0;              // joints up to it

  const char* name(int32_t row) const {
    return row < 0 ? "the root" : out->links[static_cast<size_t>(row)].name;
  }
  int32_t parent(int32_t row) const { return out->links[static_cast<size_t>(row)].parent; }
  bool hangs(int32_t row, int32_t on) const { return on < 0 || is_below(*out, row, on); }

  const Place& place(const char* option, const std::string& word) const {
    const auto found = places.find(word);
    if (found != places.end()) return found->second;
    std::vector<std::string> names;
    for (const auto& [known, p] : places) names.push_back(known);
    refuse(RDM_ERROR_NOT_FOUND, "config.%s: there is no link or site %s%s", option, clean(word).c_str(),
           nearest_hint(word, names).c_str());
  }

  void find_ends() {
    std::vector<double> straight;
    for (const rdm_robot_link& l : out->links) straight.push_back(std::clamp(0.0, l.lower, l.upper));
    poses = link_poses(*out, straight);
    const auto count = static_cast<int32_t>(out->links.size());
    for (int32_t r = 0; r < count; ++r) {
      const bool carries = std::any_of(out->links.begin(), out->links.end(),
                                       [&](const rdm_robot_link& l) { return l.parent == r; });
      if (!carries) ends.push_back(r);
    }
    for (int32_t r = 0; r < count; ++r)
      if (std::all_of(ends.begin(), ends.end(), [&](int32_t e) { return is_below(*out, e, r); }))
        fork = r, ++stem;
  }

  int32_t kind() {
    if (options.kind >= 0) return options.kind;
    const bool hand = !options.tips.empty() || !options.palm.empty();
    const bool arm = ends.size() == 1 || stem >= kLongStem;
    const int32_t k = hand ? RDM_ROBOT_HAND : arm ? RDM_ROBOT_ARM : RDM_ROBOT_HAND;
    if (!hand)
      out->note(RDM_NOTE_GUESSED, 0, "%s: %zu chain%s after a common chain of %d joints",
                k == RDM_ROBOT_ARM ? "an arm" : "a hand", ends.size(), ends.size() == 1 ? "" : "s", stem);
    return k;
  }

  void give_flange() {
    rdm_robot_def& d = out->def;
    if (options.flange == "none") return;
    Place at;
    if (!options.flange.empty()) {
      at = place("flange", options.flange);
      if (at.row < 0)
        refuse(RDM_ERROR_ARGUMENT, "config.flange: %s is part of the root", clean(options.flange).c_str());
    } else {
      at = {ends.size() == 1 ? ends[0] : fork, {}};
      const char* found = nullptr;
      for (const char* known : {"tool0", "flange", "attachment_site", "ee_link", "tool_frame", "ee"}) {
        for (const auto& [word, p] : places)
          if (!found && p.row >= 0 &&
              (word == known || (word.size() > std::char_traits<char>::length(known) &&
                                 word.compare(word.size() - std::char_traits<char>::length(known),
                                              std::string::npos, known) == 0)))
            found = out->keep(word), at = p;
        if (found) break;
      }
      out->note(RDM_NOTE_GUESSED, 0, "flange: %s",
                found ? found : format("the frame of the last link %s", name(at.row)).c_str());
    }
    d.flange_link = at.row;
    put(at.X.p, d.flange.p);
    put(at.X.q, d.flange.q);
  }

  // ---- hands ----
  struct Finger {
    std::string name;
    int32_t first, tip;
    V3 p_tip;
    V3 root, end;  // with the joints at 0, in the root frame
    bool thumb = false;
  };
  std::vector<Finger> fingers;

  // How far the shapes of a link reach along a direction in its frame; then the centre of its shapes by volume.
  double reach(int32_t row, V3 way) const {
    double most = 0;
    for (const rdm_robot_shape& s : out->shapes)
      if (s.link == row) most = std::max(most, dot(farthest(primitive_of(s), way), way));
    return most;
  }
  V3 middle(int32_t row) const {
    V3 sum;
    double weight = 0;
    for (const rdm_robot_shape& s : out->shapes)
      if (s.link == row) {
        const double v = volume_of(primitive_of(s));
        sum = sum + v * vec(s.pose.p), weight += v;
      }
    if (weight > 0) return (1 / weight) * sum;
    return row < 0 ? vec(out->def.root_com) : vec(out->links[static_cast<size_t>(row)].com);
  }

  static std::string lowered(const char* text) {
    std::string out;
    for (; *text; ++text) out += static_cast<char>(std::tolower(static_cast<unsigned char>(*text)));
    return out;
  }
  // The name of a finger ("index", ...) that at least half of its links and joints have in their names; "": none.
  std::string said(int32_t first, int32_t tip) const {
    static constexpr const char* kWords[][2] = {{"thumb", "thumb"},   {"index", "index"}, {"fore", "index"},
                                                {"middle", "middle"}, {"ring", "ring"},   {"pinky", "little"},
                                                {"little", "little"}};
    static constexpr const char* kCodes[][2] = {
        {"th", "thumb"}, {"ff", "index"}, {"mf", "middle"}, {"rf", "ring"}, {"lf", "little"}};
    std::vector<std::string> texts;
    for (int32_t r = first; r <= tip; ++r)
      for (const char* t :
           {out->links[static_cast<size_t>(r)].name, out->links[static_cast<size_t>(r)].joint})
        texts.push_back(lowered(t));
    // "ff_middle" is a bone of the first finger: codes of two letters go before words.
    for (const auto& [code, word] : kCodes) {
      const auto begins = [&, c = std::string(code)](const std::string& t) {
        const size_t at = t.find(c);
        return at != std::string::npos && (at == 0 || t[at - 1] == '_') && t.size() > at + 2 &&
               !std::islower(static_cast<unsigned char>(t[at + 2]));
      };
      if (static_cast<size_t>(std::count_if(texts.begin(), texts.end(), begins)) * 2 >= texts.size())
        return word;
      const auto joint = [&, c = std::string(code)](const std::string& t) {
        const size_t at = t.find(c + "j");
        return at != std::string::npos && (at == 0 || t[at - 1] == '_');
      };
      if (static_cast<size_t>(std::count_if(texts.begin(), texts.end(), joint)) * 4 >= texts.size())
        return word;
    }
    for (const auto& [part, word] : kWords)
      if (static_cast<size_t>(
              std::count_if(texts.begin(), texts.end(),
                            [&, p = part](const std::string& t) { return t.find(p) != std::string::npos; })) *
              2 >=
          texts.size())
        return word;
    return "";
  }

  void find_fingers() {
    struct End {
      int32_t row;
      bool given;
      V3 p;
    };
    std::vector<End> tips;
    if (!options.tips.empty()) {
      for (size_t at = 0; at <= options.tips.size();) {
        const size_t stop = std::min(options.tips.find(',', at), options.tips.size());
        const std::string word = options.tips.substr(at, stop - at);
        const Place& p = place("tips", word);
        if (p.row < 0) refuse(RDM_ERROR_ARGUMENT, "config.tips: %s is part of the root", clean(word).c_str());
        tips.push_back({p.row, norm(p.X.p) > 0, p.X.p});
        at = stop + 1;
      }
      for (const int32_t e : ends)
        if (std::none_of(tips.begin(), tips.end(),
                         [&](const End& t) { return t.row == e || is_below(*out, e, t.row); }))
          out->note(RDM_NOTE_DROPPED, 0, "link %s: its chain has none of the tips, so it is no finger",
                    name(e));
    } else {
      for (const int32_t e : ends) tips.push_back({e, false, {}});
    }
    if (!options.palm.empty())
      out->def.palm_link = place("palm", options.palm).row;
    else
      out->def.palm_link = tips.size() == 1 ? RDM_LINK_ROOT : common(tips);
    for (const End& t : tips) {
      Finger f{"", t.row, t.row, t.p, {}, {}, false};
      // Up to the last fork above the tip, or the palm.
      while (parent(f.first) >= 0 && parent(f.first) != out->def.palm_link &&
             hangs(f.first, out->def.palm_link)) {
        const int32_t up = parent(f.first);
        const auto others = std::count_if(tips.begin(), tips.end(), [&](const End& o) {
          return o.row != t.row && is_below(*out, o.row, up);
        });
        if (others) break;
        f.first = up;
      }
      const Pose& X = poses[static_cast<size_t>(t.row)];
      if (!t.given) f.p_tip = guessed_tip(t.row);
      f.root = poses[static_cast<size_t>(f.first)].p;
      f.end = X * f.p_tip;
      f.name = said(f.first, f.tip);
      fingers.push_back(f);
    }
    name_fingers();
  }
  template <class Tips>
  int32_t common(const Tips& tips) const {
    int32_t found = RDM_LINK_ROOT;
    for (int32_t r = 0; r < static_cast<int32_t>(out->links.size()); ++r)
      if (std::all_of(tips.begin(), tips.end(),
                      [&](const auto& t) { return t.row != r && is_below(*out, t.row, r); }))
        found = r;
    return found;
  }

  // The point of a fingertip in its link: a frame whose name has "tip", else the end of its shapes away from the
  // joint.
  V3 guessed_tip(int32_t row) const {
    for (const auto& [word, p] : places)
      if (p.row == row && norm(p.X.p) > 1e-6 && lowered(word.c_str()).find("tip") != std::string::npos) {
        // its own shapes may reach further than its frame
        const V3 way = unit(p.X.p);
        return std::max(reach(row, way), norm(p.X.p)) * way;
      }
    const V3 m = middle(row), way = unit(m, {0, 0, 1});
    const double far = reach(row, way);
    return far > 0 ? far * way : 2 * m;
  }

  void name_fingers() {
    size_t thumb = fingers.size();
    for (size_t i = 0; i < fingers.size(); ++i)
      if (thumb == fingers.size() && fingers[i].name == "thumb") thumb = i;
    const bool called = thumb < fingers.size();
    if (!called && fingers.size() > 1) {
      double least = 1e300;
      for (size_t i = 0; i < fingers.size(); ++i) {
        double sum = 0;
        for (size_t k = 0; k < fingers.size(); ++k)
          if (k != i)
            sum += dot(unit(fingers[i].end - fingers[i].root), unit(fingers[k].end - fingers[k].root)) -
                   norm(fingers[i].root - fingers[k].root);
        if (sum < least - 1e-9) least = sum, thumb = i;
      }
    }
    if (thumb < fingers.size()) fingers[thumb].thumb = true;
    std::vector<std::string> taken;
    for (size_t i = 0; i < fingers.size(); ++i) {
      Finger& f = fingers[i];
      if (f.thumb && f.name.empty()) f.name = "thumb";
      if (f.name.empty() ||
          std::any_of(taken.begin(), taken.end(), [&](const std::string& t) { return same_name(t, f.name); }))
        f.name = "finger" + std::to_string(i + 1);
      taken.push_back(f.name);
      out->note(RDM_NOTE_GUESSED, 0, "finger %s%s: from %s to %s, its tip at %.4g %.4g %.4g", f.name.c_str(),
                f.thumb ? ", the thumb" : "", name(f.first), name(f.tip), f.p_tip.x, f.p_tip.y, f.p_tip.z);
    }
  }

  // The velocity of a point per unit of joint `row`, with all joints at 0, in the root frame.
  V3 motion(int32_t row, V3 point) const {
    const Pose& X = poses[static_cast<size_t>(row)];
    const V3 axis = X.q * vec(out->links[static_cast<size_t>(row)].axis);
    return out->links[static_cast<size_t>(row)].kind == RDM_JOINT_PRISMATIC ? axis : cross(axis, point - X.p);
  }
  // +1, -1: which end of its range is farther from home.
  double far_side(int32_t row) const {
    const rdm_robot_link& l = out->links[static_cast<size_t>(row)];
    const double q = home_of(*out)[static_cast<size_t>(row)];
    return l.upper - q >= q - l.lower ? 1 : -1;
  }

  void give_hand() {
    rdm_robot_def& d = out->def;
    find_fingers();
    // The mean direction of the fingers (way), the line of their roots (across), and the side they bend to (normal).
    V3 way, first_root, last_root, centre;
    int count = 0;
    const bool gripper = fingers.size() < 4;
    double length = 0;
    for (const Finger& f : fingers) {
      centre = centre + (1.0 / static_cast<double>(fingers.size())) * f.root;
      length += norm(f.end - f.root) / static_cast<double>(fingers.size());
      if (f.thumb && !gripper) continue;
      way = way + unit(f.end - f.root);
      if (count++ == 0) first_root = f.root;
      last_root = f.root;
    }
    way = unit(way);
    // A gripper closes between its thumb and the middle of the others.
    if (gripper && count > 1)
      for (const Finger& f : fingers)
        if (f.thumb) last_root = f.root, first_root = (1.0 / (count - 1)) * (count * centre - f.root);
    V3 across = first_root - last_root;
    across = unit(across - dot(across, way) * way,
                  unit(cross(way, std::abs(way.x) < 0.7 ? V3{1, 0, 0} : V3{0, 1, 0})));
    V3 normal = cross(way, across);
    if (gripper) {
      normal = way;
      way = across;
    } else {
      double bend = 0;
      for (const Finger& f : fingers)
        for (int32_t r = f.first; r <= f.tip && !f.thumb; ++r) {
          const V3 axis = poses[static_cast<size_t>(r)].q * vec(out->links[static_cast<size_t>(r)].axis);
          if (std::abs(dot(axis, across)) > 0.7) bend += far_side(r) * dot(motion(r, f.end), normal);
        }
      if (bend < 0) normal = -1 * normal;
    }
    const Pose palm = pose_of(poses, d.palm_link);
    const V3 n = back(palm.q) * normal, z = back(palm.q) * way;
    // The palm's surface: from the middle between palm and finger roots outwards, at most 3 cm.
    V3 p = 0.5 * (middle(d.palm_link) + back(palm) * centre);
    double above = dot(p, n);
    for (const rdm_robot_shape& s : out->shapes)
      if (s.link == d.palm_link)
        above = std::max(above, std::min(dot(farthest(primitive_of(s), n), n), dot(p, n) + 0.03));
    p = p + (above - dot(p, n)) * n;
    put(p, d.palm_p);
    put(n, d.palm_normal);
    put(z, d.palm_fingers);
    put(p + (gripper ? 0.6 * length : 0.03) * n + (gripper ? 0.0 : 0.25 * length) * z, d.hold_p);
    give_mount(gripper ? normal : way);
    // A left hand is mirrored along the axis of the root that is nearest to the line across the fingers.
    const V3 a = gripper ? way : across;
    d.mirror = std::abs(a.x) >= std::abs(a.y) && std::abs(a.x) >= std::abs(a.z) ? 0
               : std::abs(a.y) >= std::abs(a.z)                                 ? 1
                                                                                : 2;
    out->note(
        RDM_NOTE_GUESSED, 0,
        "palm: %s, its normal %.3g %.3g %.3g, fingers towards %.3g %.3g %.3g; a left hand is mirrored in %c",
        name(d.palm_link), n.x, n.y, n.z, z.x, z.y, z.z, "xyz"[d.mirror]);
    give_fingers(normal);
    give_poses(normal);
  }

  void give_mount(V3 way) {
    rdm_robot_def& d = out->def;
    Pose X;
    if (!options.mount.empty()) {
      const char *c = options.mount.data(), *end = c + options.mount.size();
      double v[6];
      int k = 0;
      for (; k < 6; ++k) {
        while (c != end && (*c == ' ' || *c == ',')) ++c;
        const auto [after, error] = from_chars(c, end, v[k]);
        if (error != std::errc() || !(std::abs(v[k]) < 1e3)) break;
        c = after;
      }
      if (k == 6) {
        X = {{v[0], v[1], v[2]}, from_rpy({v[3], v[4], v[5]})};
      } else {
        const Place& at = place("mount", options.mount);
        if (at.row >= 0)
          refuse(RDM_ERROR_ARGUMENT, "config.mount: %s moves relative to the root",
                 clean(options.mount).c_str());
        X = at.X;
      }
    } else {
      int axis = 0;
      for (int i = 1; i < 3; ++i)
        if (std::abs(way[i]) > std::abs(way[axis])) axis = i;
      V3 straight;
      straight[axis] = way[axis] < 0 ? -1 : 1;
      X.q = turn_between({0, 0, 1}, straight);
      out->note(RDM_NOTE_GUESSED, 0, "mount: the origin of the root, z along its %s%c axis",
                way[axis] < 0 ? "-" : "", "xyz"[axis]);
    }
    put(X.p, d.mount.p);
    put(X.q, d.mount.q);
  }

  void give_fingers(V3 normal) {
    for (const Finger& f : fingers) {
      rdm_robot_finger o{};
      o.name = out->keep(f.name);
      o.first = f.first;
      o.tip = f.tip;
      o.lateral = o.proximal = o.middle = -1;
      o.thumb = f.thumb;
      put(f.p_tip, o.p_tip);
      const V3 way = unit(f.end - f.root);
      for (int32_t r = f.first; r <= f.tip; ++r) {
        const V3 axis = poses[static_cast<size_t>(r)].q * vec(out->links[static_cast<size_t>(r)].axis);
        const bool spreads = std::abs(dot(axis, normal)) > 0.7, rolls = std::abs(dot(axis, way)) > 0.7;
        if (o.lateral < 0 && spreads && !rolls && o.proximal < 0)
          o.lateral = r;
        else if (!rolls && o.proximal < 0)
          o.proximal = r;
        else if (!rolls && o.middle < 0 && o.proximal >= 0)
          o.middle = r;
      }
      out->fingers.push_back(o);
    }
  }

  // Poses that tasks start from. closed: each joint half way to the end that brings the tip to the palm; folded: only
  // the thumb bent, across the palm.
  void give_poses(V3 normal) {
    const auto home = home_of(*out);
    out->folded = home;
    std::vector<double> closed = home;
    for (const Finger& f : fingers)
      for (int32_t r = f.first; r <= f.tip; ++r) {
        const auto k = static_cast<size_t>(r);
        const rdm_robot_link& l = out->links[k];
        const V3 m = motion(r, f.end);
        // toward the palm's side, and for a thumb or a gripper toward the middle of the others
        V3 other;
        for (const Finger& o : fingers)
          if (&o != &f)
            other = other + (1.0 / static_cast<double>(std::max<size_t>(fingers.size() - 1, 1))) * o.end;
        const V3 to = unit(unit(other - f.end) + (f.thumb ? 0.5 : 1.0) * normal);
        const double bend = dot(unit(m), to);
        if (norm(m) < 1e-6 || std::abs(bend) < 0.25) continue;
        const double end = bend > 0 ? l.upper : l.lower;
        closed[k] = home[k] + 0.5 * (end - home[k]);
        if (f.thumb) out->folded[k] = home[k] + 0.4 * (end - home[k]);
      }
    const auto follows = [&](int32_t row) {
      return std::any_of(out->couplings.begin(), out->couplings.end(),
                         [&](const rdm_robot_coupling& c) { return c.link == row; });
    };
    for (const rdm_robot_coupling& c : out->couplings) {
      const auto k = static_cast<size_t>(c.link);
      const auto to = [&](std::vector<double>& q) {
        q[k] =
            std::clamp(c.ratio * q[static_cast<size_t>(c.other)], out->links[k].lower, out->links[k].upper);
      };
      to(closed), to(out->folded);
    }
    for (int32_t r = 0; r < static_cast<int32_t>(out->links.size()); ++r) {
      if (follows(r)) continue;
      const auto k = static_cast<size_t>(r);
      double low = out->links[k].lower, high = out->links[k].upper;
      for (const rdm_robot_curve& c : out->curves)
        if (c.link == r) low = c.angle[0], high = c.angle[1];
      out->closed.push_back(
          static_cast<float>(std::clamp(2 * (closed[k] - low) / (high - low) - 1, -1.0, 1.0)));
    }
    out->note(RDM_NOTE_GUESSED, 0, "poses folded and closed: joints half bent, the thumb across the palm");
  }

  void give() {
    find_ends();
    out->def.kind = kind();
    if (out->def.kind == RDM_ROBOT_HAND) give_hand();
    if (out->def.kind == RDM_ROBOT_ARM || (!options.flange.empty() && out->def.kind == RDM_ROBOT_OTHER))
      give_flange();
  }
};

}  // namespace

void give_roles(const Places& places, const Options& options, Draft* out) {
  Guess guess{places, options, out, {}, {}, RDM_LINK_ROOT, 0, {}};
  guess.give();
}

}  // namespace rdm::import
