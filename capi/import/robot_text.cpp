// The .robot file: TOML, one key for each member of rdm_robot_def and its rows, rows named instead of
// numbered. Numbers are the shortest text that reads back to the same bits. A key that is left out is 0,
// "none" or what rdm_robot_def_init gives.
#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstring>
#include <initializer_list>
#include <limits>

#include "base/chars.hpp"
#include "toml_text.hpp"

namespace rdm::import {
namespace {

constexpr int kFormat = 1;
constexpr const char* kKinds[] = {"other", "hand", "arm"};
constexpr const char* kJoints[] = {"revolute", "prismatic"};
constexpr const char* kRoot = "root";
constexpr uint8_t kGrey[] = {178, 178, 184, 255};

// ---- writing ----
template <class T>
std::string number_text(const char* key, T x) {
  if (!std::isfinite(x)) refuse(RDM_ERROR_ARGUMENT, "def: %s: a number is not finite", key);
  char text[40];
  const auto end = to_chars(text, text + sizeof text, x).ptr;
  std::string out(text, end);
  if (out.find_first_of(".e") == std::string::npos) out += ".0";
  return out;
}

struct Writer {
  const rdm_robot_def& d;
  std::string out;

  std::string quoted(const char* text) const {
    std::string s = "\"";
    for (const char* c = text; *c; ++c) {
      const auto byte = static_cast<unsigned char>(*c);
      if (*c == '"' || *c == '\\')
        s += '\\', s += *c;
      else if (byte < 0x20 || byte == 0x7f)
        s += format("\\u%04X", byte);
      else
        s += *c;
    }
    return s + '"';
  }
  void line(const char* key, const std::string& value) { out += std::string(key) + " = " + value + '\n'; }
  template <class T>
  void list(const char* key, const T* x, int32_t count) {
    std::string s = "[";
    for (int32_t i = 0; i < count; ++i) s += (i ? ", " : "") + number_text(key, x[i]);
    line(key, s + ']');
  }
  // What differs from its default alone: files stay short, and nothing is lost.
  void number(const char* key, double x) {
    if (x != 0 || std::signbit(x)) line(key, number_text(key, x));
  }
  void numbers(const char* key, const double* x, int32_t count, const double* otherwise = nullptr) {
    bool differs = false;
    for (int32_t i = 0; i < count; ++i) {
      const double o = otherwise ? otherwise[i] : 0;
      differs = differs || x[i] != o || std::signbit(x[i]) != std::signbit(o);
    }
    if (differs) list(key, x, count);
  }
  void turn(const char* key, const double* q) {
    static constexpr double kNone[4] = {0, 0, 0, 1};
    numbers(key, q, 4, kNone);
  }
  std::string link(int32_t row, const char* what) const {
    if (row == RDM_LINK_ROOT) return quoted(kRoot);
    if (row < 0 || row >= d.num_links)
      refuse(RDM_ERROR_ARGUMENT, "def: %s: there is no row %d of links", what, row);
    return quoted(d.links[row].name);
  }
  std::string shape(int32_t row) const {
    if (row < 0 || row >= d.num_shapes)
      refuse(RDM_ERROR_ARGUMENT, "def.pairs: there is no row %d of shapes", row);
    return quoted(d.shapes[row].name);
  }

  // Rows are referred to by name: each must have one of its own, and none may be the root's.
  void check() const {
    const auto rows = [](const void* array, int32_t count, const char* what) {
      if (count < 0 || count > 4096)
        refuse(RDM_ERROR_RANGE, "def.num_%s: %d is outside [0, 4096]", what, count);
      if (count > 0 && !array) refuse(RDM_ERROR_ARGUMENT, "def.%s is NULL with num_%s %d", what, what, count);
    };
    rows(d.links, d.num_links, "links");
    if (d.num_links < 1) refuse(RDM_ERROR_RANGE, "def.num_links: 0 is outside [1, %d]", RDM_MAX_LINKS);
    rows(d.shapes, d.num_shapes, "shapes");
    rows(d.pairs, std::max(d.num_pairs, 0), "pairs");
    rows(d.couplings, d.num_couplings, "couplings");
    rows(d.curves, d.num_curves, "curves");
    rows(d.commands, std::max(d.num_commands, 0), "commands");
    rows(d.fingers, d.num_fingers, "fingers");
    if (!d.name) refuse(RDM_ERROR_ARGUMENT, "def.name is NULL");
    if (d.kind < 0 || d.kind > 2) refuse(RDM_ERROR_RANGE, "def.kind: %d is outside [0, 2]", d.kind);
    for (int32_t i = 0; i < d.num_links; ++i) {
      const rdm_robot_link& l = d.links[i];
      if (!l.name || !l.joint) refuse(RDM_ERROR_ARGUMENT, "def.links: row %d has no name", i);
      if (l.kind < 0 || l.kind > 1)
        refuse(RDM_ERROR_RANGE, "def.links: kind %d of %s is outside [0, 1]", l.kind, clean(l.name).c_str());
      if (same_name(l.name, kRoot))
        refuse(RDM_ERROR_ARGUMENT, "def.links: row %d has the name root, which is reserved", i);
      for (int32_t k = 0; k < i; ++k)
        if (same_name(d.links[k].name, l.name))
          refuse(RDM_ERROR_ARGUMENT, "def.links: %s occurs twice", clean(l.name).c_str());
    }
    for (int32_t i = 0; i < d.num_shapes; ++i) {
      if (!d.shapes[i].name) refuse(RDM_ERROR_ARGUMENT, "def.shapes: row %d has no name", i);
      if (d.num_pairs > 0)
        for (int32_t k = 0; k < i; ++k)
          if (same_name(d.shapes[k].name, d.shapes[i].name))
            refuse(RDM_ERROR_ARGUMENT, "def.shapes: %s occurs twice", clean(d.shapes[i].name).c_str());
    }
    for (int32_t i = 0; i < d.num_fingers; ++i)
      if (!d.fingers[i].name) refuse(RDM_ERROR_ARGUMENT, "def.fingers: row %d has no name", i);
    for (int32_t i = 0; i < d.num_curves; ++i)
      if (d.curves[i].num_knots < 0 || d.curves[i].num_knots > RDM_MAX_KNOTS)
        refuse(RDM_ERROR_RANGE, "def.curves: num_knots %d is outside [2, %d]", d.curves[i].num_knots,
               RDM_MAX_KNOTS);
  }

  std::string write() {
    check();
    const int32_t n = d.num_links;
    out =
        "# A robot of redman: m, kg, s, rad, N; quaternions are x, y, z, w. What is left out is 0 or none.\n";
    line("format", std::to_string(kFormat));
    line("name", quoted(d.name));
    if (d.alias) line("alias", quoted(d.alias));
    if (d.summary) line("summary", quoted(d.summary));
    line("kind", quoted(kKinds[d.kind]));
    if (d.mirror >= 0 && d.mirror < 3) line("mirror", quoted(format("%c", "xyz"[d.mirror]).c_str()));
    if (d.home) list("home", d.home, n);
    if (d.folded) list("folded", d.folded, n);
    if (d.num_commands < 0) {
      line("commands", quoted("none"));
    } else if (d.commands) {
      std::string s = "[";
      for (int32_t i = 0; i < d.num_commands; ++i) s += (i ? ", " : "") + link(d.commands[i], "commands");
      line("commands", s + ']');
    }
    if (d.closed) list("closed", d.closed, num_commands(d));
    if (d.num_pairs < 0) {
      line("pairs", quoted("all"));
    } else if (d.num_pairs > 0) {
      out += "pairs = [\n";
      for (int32_t i = 0; i < d.num_pairs; ++i)
        out += "  [" + shape(d.pairs[i].a) + ", " + shape(d.pairs[i].b) + "],\n";
      out += "]\n";
    }
    out += "\n[root]\n";
    number("mass", d.root_mass);
    numbers("com", d.root_com, 3);
    numbers("moment", d.root_moment, 6);
    out += "\n[mount]\n";
    numbers("p", d.mount.p, 3);
    turn("q", d.mount.q);
    out += "\n[flange]\n";
    if (d.flange_link != RDM_LINK_NONE) line("link", link(d.flange_link, "flange_link"));
    numbers("p", d.flange.p, 3);
    turn("q", d.flange.q);
    out += "\n[palm]\n";
    static constexpr double kNormal[3] = {0, -1, 0}, kWay[3] = {0, 0, 1};
    if (d.palm_link != RDM_LINK_NONE) line("link", link(d.palm_link, "palm_link"));
    numbers("p", d.palm_p, 3);
    numbers("normal", d.palm_normal, 3, kNormal);
    numbers("fingers", d.palm_fingers, 3, kWay);
    numbers("hold", d.hold_p, 3);
    for (int32_t i = 0; i < n; ++i) write_link(d.links[i]);
    for (int32_t i = 0; i < d.num_shapes; ++i) write_shape(d.shapes[i]);
    for (int32_t i = 0; i < d.num_couplings; ++i) {
      const rdm_robot_coupling& c = d.couplings[i];
      out += "\n[[coupling]]\n";
      line("link", link(c.link, "couplings"));
      line("other", link(c.other, "couplings"));
      number("ratio", c.ratio);
      number("slack", c.slack);
    }
    for (int32_t i = 0; i < d.num_curves; ++i) {
      const rdm_robot_curve& c = d.curves[i];
      out += "\n[[curve]]\n";
      line("link", link(c.link, "curves"));
      line("driver", link(c.driver, "curves"));
      list("command", c.command, c.num_knots);
      list("angle", c.angle, c.num_knots);
    }
    for (int32_t i = 0; i < d.num_fingers; ++i) {
      const rdm_robot_finger& f = d.fingers[i];
      out += "\n[[finger]]\n";
      line("name", quoted(f.name));
      line("first", link(f.first, "fingers"));
      line("tip", link(f.tip, "fingers"));
      if (f.lateral != -1) line("lateral", link(f.lateral, "fingers"));
      if (f.proximal != -1) line("proximal", link(f.proximal, "fingers"));
      if (f.middle != -1) line("middle", link(f.middle, "fingers"));
      if (f.thumb) line("thumb", "true");
      numbers("p_tip", f.p_tip, 3);
    }
    return out;
  }
  // Commands of rdm_robot_create when there is no list: rows that follow no other and have no other's curve.
  static int32_t num_commands(const rdm_robot_def& d) {
    if (d.num_commands < 0) return 0;
    if (d.commands) return d.num_commands;
    int32_t count = 0;
    for (int32_t i = 0; i < d.num_links; ++i) {
      bool follows = false;
      for (int32_t k = 0; k < d.num_couplings; ++k) follows = follows || d.couplings[k].link == i;
      for (int32_t k = 0; k < d.num_curves; ++k)
        follows = follows || (d.curves[k].link == i && d.curves[k].driver != i);
      count += follows ? 0 : 1;
    }
    return count;
  }
  void write_link(const rdm_robot_link& l) {
    out += "\n[[link]]\n";
    line("name", quoted(l.name));
    line("joint", quoted(l.joint));
    line("parent", link(l.parent, "parent"));
    line("kind", quoted(kJoints[l.kind]));
    numbers("p", l.pose.p, 3);
    turn("q", l.pose.q);
    numbers("axis", l.axis, 3);
    list("range", &l.lower, 2);
    static_assert(offsetof(rdm_robot_link, upper) == offsetof(rdm_robot_link, lower) + sizeof l.lower);
    number("velocity", l.velocity);
    number("kp", l.kp);
    number("kd", l.kd);
    number("effort", l.effort);
    number("armature", l.armature);
    number("friction", l.friction);
    number("mass", l.mass);
    numbers("com", l.com, 3);
    numbers("moment", l.moment, 6);
  }
  void write_shape(const rdm_robot_shape& s) {
    out += "\n[[shape]]\n";
    line("name", quoted(s.name));
    line("link", link(s.link, "shapes"));
    const char* kind = nullptr;
    for (int32_t k = 0; k < kRobotShapes; ++k)
      if (kShapes[k].kind == s.kind) kind = kShapes[k].name;
    if (!kind)
      refuse(RDM_ERROR_RANGE, "def.shapes: kind %d of %s cannot be part of a robot", s.kind,
             clean(s.name).c_str());
    line("kind", quoted(kind));
    numbers("size", used_size(s.kind, s.size).data(), 3);
    numbers("p", s.pose.p, 3);
    turn("q", s.pose.q);
    line("color", format("[%d, %d, %d]", s.color[0], s.color[1], s.color[2]));
  }
};

// ---- reading ----
struct RobotReader {
  const Table& top;
  Draft* out;

  int32_t link(const Table& t, const char* key, const toml::node& n) const {
    const std::string text = t.as_text(n, key);
    if (text == kRoot) return RDM_LINK_ROOT;
    std::vector<std::string> names{kRoot};
    for (size_t i = 0; i < out->links.size(); ++i) {
      if (text == out->links[i].name) return static_cast<int32_t>(i);
      names.emplace_back(out->links[i].name);
    }
    t.bad(RDM_ERROR_NOT_FOUND, line_of(n), "%s: there is no link %s before it%s", key, clean(text).c_str(),
          nearest_hint(text, names).c_str());
  }
  int32_t link_or(const Table& t, const char* key, int32_t otherwise) const {
    const toml::node* n = t.find(key);
    return n ? link(t, key, *n) : otherwise;
  }
  const char* name(const Table& t, const char* key) { return out->keep(t.as_text(t.need(key), key)); }

  void read_links() {
    for (const Table& t : top.rows("link")) {
      t.only({"name", "joint", "parent", "kind", "p", "q", "axis", "range", "velocity", "kp", "kd", "effort",
              "armature", "friction", "mass", "com", "moment"});
      if (out->links.size() == RDM_MAX_LINKS)
        t.bad(RDM_ERROR_RANGE, line_of(t.t), "there are more than %d links", RDM_MAX_LINKS);
      rdm_robot_link l{};
      l.name = name(t, "name");
      l.joint = name(t, "joint");
      l.parent = link(t, "parent", t.need("parent"));
      l.kind = t.choice("kind", kJoints, 2, 0);
      l.pose.q[3] = 1;
      t.numbers("p", l.pose.p, 3);
      t.numbers("q", l.pose.q, 4);
      t.need("axis");
      t.numbers("axis", l.axis, 3);
      const auto range = t.list(t.need("range"), "range", 2, 2);
      l.lower = range[0], l.upper = range[1];
      t.number("velocity", &l.velocity);
      t.number("kp", &l.kp);
      t.number("kd", &l.kd);
      t.number("effort", &l.effort);
      t.number("armature", &l.armature);
      t.number("friction", &l.friction);
      t.number("mass", &l.mass);
      t.numbers("com", l.com, 3);
      t.numbers("moment", l.moment, 6);
      out->links.push_back(l);
    }
    if (out->links.empty()) top.bad(RDM_ERROR_FORMAT, line_of(top.t), "there is no [[link]]");
  }
  void read_shapes() {
    for (const Table& t : top.rows("shape")) {
      t.only({"name", "link", "kind", "size", "p", "q", "color"});
      rdm_robot_shape s{};
      s.name = name(t, "name");
      s.link = link(t, "link", t.need("link"));
      s.kind = shape_kind(t, kRobotShapes);
      read_size(t, s.kind, s.size);
      s.pose.q[3] = 1;
      t.numbers("p", s.pose.p, 3);
      t.numbers("q", s.pose.q, 4);
      std::copy_n(kGrey, 4, s.color);
      read_color(t, s.color);
      out->shapes.push_back(s);
    }
  }
  int32_t shape(const toml::node& n) const {
    const std::string text = top.as_text(n, "pairs");
    std::vector<std::string> names;
    for (size_t i = 0; i < out->shapes.size(); ++i) {
      if (text == out->shapes[i].name) return static_cast<int32_t>(i);
      names.emplace_back(out->shapes[i].name);
    }
    top.bad(RDM_ERROR_NOT_FOUND, line_of(n), "pairs: there is no shape %s%s", clean(text).c_str(),
            nearest_hint(text, names).c_str());
  }
  void read_pairs() {
    const toml::node* n = top.find("pairs");
    if (!n) return;
    if (n->is_string() && n->as_string()->get() == "all") {
      out->all_pairs = true;
      return;
    }
    const toml::array* a = n->as_array();
    if (!a || a->size() > 4096)
      top.bad(RDM_ERROR_FORMAT, line_of(*n),
              "pairs is neither \"all\" nor a list of at most 4096 pairs of shapes");
    for (const toml::node& x : *a) {
      const toml::array* pair = x.as_array();
      if (!pair || pair->size() != 2) top.bad(RDM_ERROR_FORMAT, line_of(x), "pairs: a row is not two shapes");
      out->pairs.push_back({shape(*pair->get(0)), shape(*pair->get(1))});
    }
  }
  void read_rows() {
    for (const Table& t : top.rows("coupling")) {
      t.only({"link", "other", "ratio", "slack"});
      rdm_robot_coupling c{};
      c.link = link(t, "link", t.need("link"));
      c.other = link(t, "other", t.need("other"));
      t.number("ratio", &c.ratio);
      t.number("slack", &c.slack);
      out->couplings.push_back(c);
    }
    for (const Table& t : top.rows("curve")) {
      t.only({"link", "driver", "command", "angle"});
      rdm_robot_curve c{};
      c.link = link(t, "link", t.need("link"));
      c.driver = link_or(t, "driver", c.link);
      const auto command = t.list(t.need("command"), "command", 0, RDM_MAX_KNOTS);
      const auto angle = t.list(t.need("angle"), "angle", command.size(), command.size());
      c.num_knots = static_cast<int32_t>(command.size());
      std::copy(command.begin(), command.end(), c.command);
      std::copy(angle.begin(), angle.end(), c.angle);
      out->curves.push_back(c);
    }
    for (const Table& t : top.rows("finger")) {
      t.only({"name", "first", "tip", "lateral", "proximal", "middle", "thumb", "p_tip"});
      rdm_robot_finger f{};
      f.name = name(t, "name");
      f.first = link(t, "first", t.need("first"));
      f.tip = link(t, "tip", t.need("tip"));
      f.lateral = link_or(t, "lateral", -1);
      f.proximal = link_or(t, "proximal", -1);
      f.middle = link_or(t, "middle", -1);
      f.thumb = t.flag("thumb");
      t.numbers("p_tip", f.p_tip, 3);
      out->fingers.push_back(f);
    }
    if (const toml::node* n = top.find("commands")) {
      const toml::array* a = n->as_array();
      out->passive = n->value<std::string>() == "none";
      if (!a && !out->passive)
        top.bad(RDM_ERROR_FORMAT, line_of(*n), "commands is neither a list of links nor \"none\"");
      for (size_t i = 0; a && i < a->size(); ++i) {
        const toml::node& x = (*a)[i];
        out->commands.push_back(link(top, "commands", x));
      }
    }
  }
  void read_parts() {
    rdm_robot_def& d = out->def;
    const Table root = top.section("root"), mount = top.section("mount"), flange = top.section("flange"),
                palm = top.section("palm");
    root.only({"mass", "com", "moment"});
    root.number("mass", &d.root_mass);
    root.numbers("com", d.root_com, 3);
    root.numbers("moment", d.root_moment, 6);
    mount.only({"p", "q"});
    mount.numbers("p", d.mount.p, 3);
    mount.numbers("q", d.mount.q, 4);
    flange.only({"link", "p", "q"});
    d.flange_link = link_or(flange, "link", RDM_LINK_NONE);
    flange.numbers("p", d.flange.p, 3);
    flange.numbers("q", d.flange.q, 4);
    palm.only({"link", "p", "normal", "fingers", "hold"});
    d.palm_link = link_or(palm, "link", RDM_LINK_NONE);
    palm.numbers("p", d.palm_p, 3);
    palm.numbers("normal", d.palm_normal, 3);
    palm.numbers("fingers", d.palm_fingers, 3);
    palm.numbers("hold", d.hold_p, 3);
  }
  void read_poses() {
    const size_t n = out->links.size();
    if (const toml::node* x = top.find("home")) out->home = top.list(*x, "home", n, n);
    if (const toml::node* x = top.find("folded")) out->folded = top.list(*x, "folded", n, n);
    if (const toml::node* x = top.find("closed")) {
      out->bind();
      const auto count = static_cast<size_t>(Writer::num_commands(out->def));
      for (const double v : top.list(*x, "closed", count, count))
        out->closed.push_back(static_cast<float>(v));
    }
  }

  void read(const std::vector<const char*>& others, const Options& options) {
    std::vector<const char*> known = {"format", "name",     "alias",  "summary",  "kind",  "mirror", "home",
                                      "folded", "commands", "closed", "pairs",    "root",  "mount",  "flange",
                                      "palm",   "link",     "shape",  "coupling", "curve", "finger"};
    known.insert(known.end(), others.begin(), others.end());
    top.only(known);
    if (const toml::node* n = top.find("format"))
      if (!n->is_integer() || n->as_integer()->get() != kFormat)
        top.bad(RDM_ERROR_VERSION_MISMATCH, line_of(*n), "format: this library reads format %d only",
                kFormat);
    rdm_robot_def& d = out->def;
    d.name = options.name.empty() ? name(top, "name") : out->keep(options.name);
    if (const toml::node* n = top.find("alias")) {
      const char* alias = name(top, "alias");
      if (options.name.empty())
        d.alias = alias;
      else
        out->note(RDM_NOTE_DROPPED, line_of(*n), "alias %s was dropped: the robot is now called %s",
                  clean(alias).c_str(), clean(options.name).c_str());
    }
    if (top.find("summary")) d.summary = name(top, "summary");
    d.kind = options.kind >= 0 ? options.kind : top.choice("kind", kKinds, 3, 0);
    static constexpr const char* kAxes[] = {"x", "y", "z"};
    d.mirror = top.choice("mirror", kAxes, 3, -1);
    read_links();
    read_shapes();
    read_pairs();
    read_rows();
    read_parts();
    read_poses();
    out->bind();
  }
};

}  // namespace

std::string write_robot(const rdm_robot_def& def) {
  Writer writer{def, {}};
  std::string text = writer.write();
  try {
    parse_toml(text);
  } catch (const Refusal& r) {  // a name that is not UTF-8, or more than a file may have
    refuse(RDM_ERROR_ARGUMENT, "def: the file could not be read back: %s", r.text.c_str());
  }
  return text;
}

void read_robot_table(const Table& file, const std::vector<const char*>& others, const Options& options,
                      Draft* out) {
  RobotReader reader{file, out};
  reader.read(others, options);
}

void read_robot(const std::string& bytes, const Options& options, Draft* out) {
  const toml::table file = parse_toml(bytes);
  read_robot_table({file, ""}, {}, options, out);
}

}  // namespace rdm::import
