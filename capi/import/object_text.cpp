// The .object file: TOML, one key for each member of rdm_object_def and its shapes. Numbers are the shortest
// text that reads back to the same bits. A key that is left out is 0, "none" or what rdm_object_def_init
// gives.
#include <algorithm>
#include <cmath>

#include "base/chars.hpp"
#include "toml_text.hpp"

namespace rdm::import {
namespace {

constexpr int kFormat = 1;
constexpr uint8_t kGrey[] = {200, 200, 200, 255};

std::string number_text(double x) {
  if (std::isnan(x)) return std::signbit(x) ? "-nan" : "nan";
  if (std::isinf(x)) return x < 0 ? "-inf" : "inf";
  char text[40];
  std::string out(text, to_chars(text, text + sizeof text, x).ptr);
  if (out.find_first_of(".e") == std::string::npos) out += ".0";
  return out;
}

struct Writer {
  std::string out;

  void line(const char* key, const std::string& value) { out += std::string(key) + " = " + value + '\n'; }
  void text(const char* key, const char* value) {
    if (!value) return;
    std::string s = "\"";
    for (const char* c = value; *c; ++c) {
      const auto byte = static_cast<unsigned char>(*c);
      if (*c == '"' || *c == '\\')
        s += '\\', s += *c;
      else if (byte < 0x20 || byte == 0x7f)
        s += format("\\u%04X", byte);
      else
        s += *c;
    }
    line(key, s + '"');
  }
  static std::string list(const double* x, int32_t count) {
    std::string s = "[";
    for (int32_t i = 0; i < count; ++i) s += (i ? ", " : "") + number_text(x[i]);
    return s + ']';
  }
  // What differs from `otherwise` alone.
  void numbers(const char* key, const double* x, int32_t count, const double* otherwise) {
    for (int32_t i = 0; i < count; ++i)
      if (x[i] != otherwise[i] || std::signbit(x[i]) != std::signbit(otherwise[i]))
        return line(key, list(x, count));
  }
  void shape(const rdm_shape_def& s, int32_t i) {
    static constexpr double kNone[6] = {}, kNoTurn[4] = {0, 0, 0, 1};
    const char* kind = nullptr;
    for (const NamedKind& k : kShapes)
      if (k.kind == s.kind && s.kind != RDM_SHAPE_PLANE) kind = k.name;
    if (!kind) refuse(RDM_ERROR_RANGE, "def.shapes[%d]: kind %d cannot be part of an object", i, s.kind);
    out += "\n[[shape]]\n";
    text("kind", kind);
    if (s.kind == RDM_SHAPE_HULL) {
      if (s.num_points < 4 || s.num_points > 32)
        refuse(RDM_ERROR_RANGE, "def.shapes[%d].num_points: %d is outside [4, 32]", i, s.num_points);
      if (!s.points) refuse(RDM_ERROR_ARGUMENT, "def.shapes[%d].points is NULL", i);
      out += "points = [\n";
      for (int32_t k = 0; k < s.num_points; ++k) out += "  " + list(s.points + 3 * k, 3) + ",\n";
      out += "]\n";
    } else {
      numbers("size", used_size(s.kind, s.size).data(), 3, kNone);
    }
    numbers("p", s.pose.p, 3, kNone);
    const bool none = s.pose.q[0] == 0 && s.pose.q[1] == 0 && s.pose.q[2] == 0 && s.pose.q[3] == 0;
    if (!none) numbers("q", s.pose.q, 4, kNoTurn);
    if (s.color[0] || s.color[1] || s.color[2] || s.color[3])
      line("color", format("[%d, %d, %d]", s.color[0], s.color[1], s.color[2]));
    if (s.seen_only) line("seen_only", "true");
  }
};

struct ObjectReader {
  ObjectDraft* out;

  void shape(const Table& t) {
    t.only({"kind", "size", "points", "p", "q", "color", "seen_only"});
    rdm_shape_def s{};
    s.kind = shape_kind(t, static_cast<int32_t>(std::size(kShapes)));
    if (s.kind == RDM_SHAPE_PLANE)
      t.bad(RDM_ERROR_ARGUMENT, line_of(t.need("kind")), "kind: an object cannot be a plane");
    s.pose.q[3] = 1;
    t.numbers("p", s.pose.p, 3);
    t.numbers("q", s.pose.q, 4);
    std::copy_n(kGrey, 4, s.color);
    read_color(t, s.color);
    s.seen_only = t.flag("seen_only");
    if (s.kind == RDM_SHAPE_HULL) {
      const toml::node& n = t.need("points");
      const toml::array* rows = n.as_array();
      if (!rows || rows->size() < 4 || rows->size() > 32)
        t.bad(RDM_ERROR_FORMAT, line_of(n), "points is not a list of 4 to 32 points");
      std::vector<double>& points = out->points.emplace_back();
      for (const toml::node& row : *rows)
        for (const double x : t.list(row, "a point", 3, 3)) points.push_back(x);
      s.points = points.data();
      s.num_points = static_cast<int32_t>(rows->size());
    }
    read_size(t, s.kind, s.size);
    out->shapes.push_back(s);
  }

  void read(const toml::table& file) {
    const Table top{file, ""};
    top.only({"format", "name", "alias", "summary", "material", "friction", "mass", "moment", "shape"});
    if (const toml::node* n = file.get("format"))
      if (!n->is_integer() || n->as_integer()->get() != kFormat)
        top.bad(RDM_ERROR_VERSION_MISMATCH, line_of(*n), "format: this library reads format %d only",
                kFormat);
    rdm_object_def& d = out->def;
    const auto text = [&](const char* key) -> const char* {
      const toml::node* n = file.get(key);
      return n ? out->keep(top.as_text(*n, key)) : nullptr;
    };
    top.need("name");
    d.name = text("name");
    d.alias = text("alias");
    d.summary = text("summary");
    d.material = text("material");
    top.number("friction", &d.friction);
    d.mass = top.as_number(top.need("mass"), "mass");
    top.numbers("moment", d.moment, 6);
    for (const Table& t : top.rows("shape")) shape(t);
    if (out->shapes.empty()) top.bad(RDM_ERROR_FORMAT, 1, "there is no [[shape]]");
    out->bind();
  }
};

}  // namespace

ObjectDraft::ObjectDraft() {
  rdm_object_def_init(&def, sizeof def);
}

const char* ObjectDraft::keep(std::string text) {
  texts.push_back(std::move(text));
  return texts.back().c_str();
}

void ObjectDraft::bind() {
  def.shapes = shapes.data();
  def.num_shapes = static_cast<int32_t>(shapes.size());
}

std::string write_object(const rdm_object_def& def) {
  if (!def.name) refuse(RDM_ERROR_ARGUMENT, "def.name is NULL");
  if (def.num_shapes < 1 || def.num_shapes > RDM_MAX_SHAPES)
    refuse(RDM_ERROR_RANGE, "def.num_shapes: %d is outside [1, %d]", def.num_shapes, RDM_MAX_SHAPES);
  if (!def.shapes) refuse(RDM_ERROR_ARGUMENT, "def.shapes is NULL with num_shapes %d", def.num_shapes);
  Writer w;
  w.out =
      "# An object of redman: m, kg; quaternions are x, y, z, w. What is left out is 0 or none; without a "
      "moment\n# it is that of the shapes, solid, of one density.\n";
  w.line("format", std::to_string(kFormat));
  w.text("name", def.name);
  w.text("alias", def.alias);
  w.text("summary", def.summary);
  w.text("material", def.material);
  w.line("friction", number_text(def.friction));
  w.line("mass", number_text(def.mass));
  static constexpr double kNone[6] = {};
  w.numbers("moment", def.moment, 6, kNone);
  for (int32_t i = 0; i < def.num_shapes; ++i) w.shape(def.shapes[i], i);
  return w.out;
}

void read_object(const std::string& bytes, ObjectDraft* out) {
  const toml::table file = parse_toml(bytes);
  ObjectReader{out}.read(file);
}

void read_built_object(int32_t object, ObjectDraft* out) {
  if (const rdm_result r = rdm_object_get_def(object, &out->def)) refuse(r, "%s", rdm_last_error());
  for (int32_t i = 0; i < out->def.num_shapes; ++i) {
    rdm_shape_def s;
    if (const rdm_result r = rdm_object_shape_at(object, i, &s)) refuse(r, "%s", rdm_last_error());
    if (s.points) {
      const std::vector<double>& own = out->points.emplace_back(s.points, s.points + 3 * s.num_points);
      s.points = own.data();
    }
    out->shapes.push_back(s);
  }
  // Texts belong to the object, which may go before the handle does.
  for (const char** text : {&out->def.name, &out->def.alias, &out->def.summary, &out->def.material})
    if (*text) *text = out->keep(*text);
  out->bind();
}

}  // namespace rdm::import
