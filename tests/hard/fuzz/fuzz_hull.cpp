// Points of hulls, as text and as numbers: a hull that is taken has a volume, a centre within its box, faces
// that hold all of its corners, and moments that a solid can have.
#include "base/error.hpp"
#include "fuzz.hpp"
#include "objects/hull_text.hpp"
#include "physics/model/hull.hpp"

namespace hard {

std::vector<Bytes> seeds() {
  std::vector<Bytes> out;
  for (const char* text :
       {"0.05,0,0;-0.05,0,0;0,0.05,0;0,-0.05,0;0,0,0.05;0,0,-0.05", "0,0,0;1,0,0;0,1,0;0,0,1",
        "1,1,1;1,1,-1;1,-1,1;1,-1,-1;-1,1,1;-1,1,-1;-1,-1,1;-1,-1,-1",
        "0,0,0;1,0,0;0,1,0;0.3,0.3,1e-9;0,0,1e-3"})
    out.push_back(with_pick(0, bytes_of(text)));
  const double numbers[15] = {0, 0, 0, 0.1, 0, 0, 0, 0.1, 0, 0, 0, 0.1, 0.1, 0.1, 0.1};
  Bytes raw(sizeof numbers);
  std::memcpy(raw.data(), numbers, sizeof numbers);
  out.push_back(with_pick(1, raw));
  return out;
}
void whole(unsigned char*, size_t) {}
size_t fixed_bytes() {
  return 1;
}

void one(const unsigned char* data, size_t size) {
  if (size == 0) return;
  try {
    rdm::Vector<rdm::Vec3> points;
    if (pick(data, size, 2) == 0) {
      points = rdm::hull_points_from(std::string(reinterpret_cast<const char*>(data + 1), size - 1).c_str());
    } else {
      for (size_t at = 1; at + 24 <= size; at += 24) {
        double v[3];
        std::memcpy(v, data + at, sizeof v);
        points.push_back({v[0], v[1], v[2]});
      }
    }
    const rdm::Hull hull = rdm::make_hull(points.data(), static_cast<int32_t>(points.size()), "hull");
    HARD_REQUIRE(std::isfinite(hull.volume) && hull.volume > 0, "volume %g", hull.volume);
    const rdm::Vec3 box = rdm::half_box(hull);
    const double span = 2 * std::max(box.x, std::max(box.y, box.z));
    for (double m : hull.moment) HARD_REQUIRE(std::isfinite(m), "a moment is not finite");
    HARD_REQUIRE(hull.moment[0] > 0 && hull.moment[0] <= span * span * 2, "moment %g of span %g",
                 hull.moment[0], span);
    HARD_REQUIRE(hull.num_points >= 4 && hull.num_faces >= 4, "%d corners, %d faces", hull.num_points,
                 hull.num_faces);
    for (int32_t f = 0; f < hull.num_faces; ++f)
      for (int32_t i = 0; i < hull.num_points; ++i)
        HARD_REQUIRE(dot(hull.faces[f].n, hull.points[i]) <= hull.faces[f].offset + 1e-3 * span,
                     "corner %d is outside face %d", i, f);
  } catch (const rdm::Error& e) {
    HARD_REQUIRE(good_text(e.text) && e.code != rdm::Code::kInternal, "%s", e.text);
  }
}

}  // namespace hard
