// Objects as text: every one reads back to the last bit, and what cannot be one is refused with line and key.
#include <gtest/gtest.h>
#include <redman/import.h>

#include <cstring>
#include <string>
#include <vector>

#include "written.hpp"

namespace {

struct Import {
  rdm_import* handle = nullptr;
  rdm_object_def def;
  explicit Import(rdm_import* made) : handle(made) {
    rdm_object_def_init(&def, sizeof def);
    if (made) {
      EXPECT_EQ(rdm_import_get_object_def(handle, &def), RDM_OK) << rdm_import_error();
    }
  }
  Import(const Import&) = delete;
  Import& operator=(const Import&) = delete;
  ~Import() { rdm_import_destroy(handle); }
};

rdm_import* from_text(const std::string& text) {
  rdm_import* i = nullptr;
  EXPECT_EQ(rdm_import_read_object(&i, text.data(), text.size()), RDM_OK) << rdm_import_error();
  return i;
}
std::string written(const rdm_object_def& def) {
  return written_text(
      [&](char* out, size_t n, size_t* size) { return rdm_import_write_object(&def, out, n, size); });
}

TEST(ObjectText, EveryObjectReadsBackToTheBit) {
  for (int32_t i = 0; i < rdm_object_count(); ++i) {
    rdm_import* built = nullptr;
    ASSERT_EQ(rdm_import_create_object(&built, i), RDM_OK) << rdm_import_error();
    const Import a(built);
    const std::string text = written(a.def);
    const Import b(from_text(text));
    EXPECT_STREQ(a.def.name, b.def.name);
    EXPECT_STREQ(a.def.summary, b.def.summary);
    EXPECT_STREQ(a.def.material, b.def.material);
    EXPECT_EQ(a.def.alias == nullptr, b.def.alias == nullptr);
    EXPECT_EQ(std::memcmp(&a.def.mass, &b.def.mass, sizeof(double)), 0);
    EXPECT_EQ(std::memcmp(a.def.moment, b.def.moment, sizeof a.def.moment), 0) << a.def.name;
    EXPECT_EQ(a.def.friction, b.def.friction);
    ASSERT_EQ(a.def.num_shapes, b.def.num_shapes);
    for (int32_t k = 0; k < a.def.num_shapes; ++k) {
      const rdm_shape_def &s = a.def.shapes[k], &t = b.def.shapes[k];
      EXPECT_EQ(s.kind, t.kind);
      EXPECT_EQ(std::memcmp(s.size, t.size, sizeof s.size), 0) << a.def.name << k;
      EXPECT_EQ(std::memcmp(s.pose.p, t.pose.p, sizeof s.pose.p), 0) << a.def.name << k;
      EXPECT_EQ(std::memcmp(s.pose.q, t.pose.q, sizeof s.pose.q), 0) << a.def.name << k;
      EXPECT_EQ(std::memcmp(s.color, t.color, 4), 0);
      ASSERT_EQ(s.num_points, t.num_points);
      if (s.num_points > 0) {
        EXPECT_EQ(std::memcmp(s.points, t.points, sizeof(double) * 3 * static_cast<size_t>(s.num_points)), 0);
      }
    }
    EXPECT_EQ(written(b.def), text) << a.def.name;
  }
}

TEST(ObjectText, WhatIsLeftOutIsTheDefault) {
  const Import i(from_text("name = 'brick'\nmass = 1\n[[shape]]\nkind = 'box'\nsize = [0.1, 0.05, 0.03]\n"));
  EXPECT_STREQ(i.def.name, "brick");
  EXPECT_EQ(i.def.alias, nullptr);
  EXPECT_EQ(i.def.friction, 0.5);
  EXPECT_EQ(i.def.moment[0], 0);
  EXPECT_EQ(i.def.shapes[0].pose.q[3], 1);
  EXPECT_EQ(i.def.shapes[0].color[0], 200);
  int32_t object = -1;
  ASSERT_EQ(rdm_object_create(&object, &i.def), RDM_OK) << rdm_last_error();
  EXPECT_EQ(rdm_object_destroy(object), RDM_OK);
}

TEST(ObjectText, RefusalsNameTheLine) {
  const std::string head = "name = 'brick'\nmass = 1\n",
                    shape = "[[shape]]\nkind = 'box'\nsize = [0.1, 0.1, 0.1]\n";
  const struct {
    rdm_result code;
    const char* text;
    std::string file;
  } rows[] = {
      {RDM_ERROR_FORMAT, "line 1: name is missing", "mass = 1\n" + shape},
      {RDM_ERROR_FORMAT, "mass is missing", "name = 'brick'\n" + shape},
      {RDM_ERROR_FORMAT, "there is no [[shape]]", head},
      {RDM_ERROR_FORMAT, "line 3: weight is not a known key", head + "weight = 1\n" + shape},
      {RDM_ERROR_FORMAT, "line 2: mass is not a number", "name = 'brick'\nmass = '1'\n" + shape},
      {RDM_ERROR_FORMAT, "line 3: moment is not a list of 6 numbers", head + "moment = [1, 2]\n" + shape},
      {RDM_ERROR_VERSION_MISMATCH, "line 3: format", head + "format = 2\n" + shape},
      {RDM_ERROR_FORMAT, "line 4: shape: kind: bocks is unknown", head + "[[shape]]\nkind = 'bocks'\n"},
      {RDM_ERROR_FORMAT, "size is missing", head + "[[shape]]\nkind = 'box'\n"},
      {RDM_ERROR_FORMAT, "points is not a list of 4 to 32 points",
       head + "[[shape]]\nkind = 'hull'\npoints = [[0,0,0]]\n"},
      {RDM_ERROR_FORMAT, "a point is not a list of 3 numbers",
       head + "[[shape]]\nkind = 'hull'\npoints = [[0,0],[1,0,0],[0,1,0],[0,0,1]]\n"},
      {RDM_ERROR_RANGE, "color: 300 is outside", head + shape + "color = [300, 0, 0]\n"},
      {RDM_ERROR_FORMAT, "line 2", "name = 'brick'\nmass = \n"},
      // letters outside ASCII where a key or white space stands
      {RDM_ERROR_FORMAT, "line 3", head + "gr\u00f6\u00dfe = 1\n" + shape},
      {RDM_ERROR_FORMAT, "line 3", head + "format\u0324 = 1\n" + shape},
      {RDM_ERROR_FORMAT, "line 3", head + "\u0498 = 1\n" + shape},
      // of the library, under the file's own name
      {RDM_ERROR_RANGE, "object brick: mass -1 is outside", "name = 'brick'\nmass = -1\n" + shape},
      {RDM_ERROR_ARGUMENT, "may contain only letters", "name = 'a brick'\nmass = 1\n" + shape},
      {RDM_ERROR_ARGUMENT, "kind: an object cannot be a plane",
       head + "[[shape]]\nkind = 'plane'\nsize = [1]\n"},
      {RDM_ERROR_RANGE, "object brick: shapes[0]: size",
       head + "[[shape]]\nkind = 'box'\nsize = [1, 1, 0]\n"},
      {RDM_ERROR_ARGUMENT, "triangle inequality", head + "moment = [1, 1, 3, 0, 0, 0]\n" + shape},
  };
  for (const auto& row : rows) {
    rdm_import* i = nullptr;
    EXPECT_EQ(rdm_import_read_object(&i, row.file.data(), row.file.size()), row.code) << row.text;
    EXPECT_EQ(i, nullptr);
    EXPECT_NE(std::string(rdm_import_error()).find(row.text), std::string::npos)
        << rdm_import_error() << "\n  wants: " << row.text;
  }
}

// Reading takes no number of the catalogue's.
TEST(ObjectText, ReadingAddsNothing) {
  const int32_t before = rdm_object_count();
  for (int k = 0; k < 3; ++k)
    rdm_import_destroy(from_text("name = 'egg'\nmass = 1\n[[shape]]\nkind = 'sphere'\nsize = [0.1]\n"));
  EXPECT_EQ(rdm_object_count(), before);
}

TEST(ObjectText, HandlesAndPointersAreChecked) {
  rdm_import *object = from_text("name = 'x'\nmass = 1\n[[shape]]\nkind = 'sphere'\nsize = [0.1]\n"),
             *robot = nullptr;
  ASSERT_EQ(rdm_import_create_robot(&robot, 0), RDM_OK);
  rdm_object_def o;
  rdm_object_def_init(&o, sizeof o);
  rdm_robot_def r;
  rdm_robot_def_init(&r, sizeof r);
  EXPECT_EQ(rdm_import_get_object_def(robot, &o), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_import_get_robot_def(object, &r), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_import_check(object), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_import_note_count(object), 0);
  EXPECT_EQ(rdm_import_get_object_def(object, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_import_get_object_def(nullptr, &o), RDM_ERROR_ARGUMENT);
  o.struct_size = 4;
  EXPECT_EQ(rdm_import_get_object_def(object, &o), RDM_ERROR_ARGUMENT);
  rdm_import* none = nullptr;
  EXPECT_EQ(rdm_import_read_object_file(nullptr, "x"), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_import_read_object_file(&none, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_import_read_object_file(&none, "/nowhere.object"), RDM_ERROR_NOT_FOUND);
  EXPECT_EQ(rdm_import_read_object(&none, nullptr, 3), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_import_create_object(&none, -1), RDM_ERROR_RANGE);
  size_t size = 0;
  char small[4];
  rdm_object_def_init(&o, sizeof o);
  EXPECT_EQ(rdm_import_write_object(&o, nullptr, 0, &size), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_import_write_object(nullptr, nullptr, 0, &size), RDM_ERROR_ARGUMENT);
  ASSERT_EQ(rdm_import_get_object_def(object, &o), RDM_OK);
  EXPECT_EQ(rdm_import_write_object(&o, small, sizeof small, &size), RDM_ERROR_RANGE);
  rdm_import_destroy(object);
  rdm_import_destroy(robot);
}

TEST(ObjectText, AnyBeginningOfAFileIsSurvived) {
  rdm_import* built = nullptr;
  ASSERT_EQ(rdm_import_create_object(&built, 40), RDM_OK);
  const Import a(built);
  const std::string text = written(a.def);
  for (size_t n = 0; n < text.size(); n += 7) {
    rdm_import* i = nullptr;
    if (rdm_import_read_object(&i, text.data(), n) == RDM_OK) rdm_import_destroy(i);
  }
}

}  // namespace
