// A host may set a locale with a decimal comma: every text that the library and the importers give is the same
// then, and so is what they read.
#include <gtest/gtest.h>
#ifndef RDM_EXPERIMENTAL
#define RDM_EXPERIMENTAL
#endif
#include <redman/import.h>
#include <redman/redman.h>

#include <cstring>
#include <string>
#include <vector>

#include "comma_locale.hpp"
#include "written.hpp"

namespace {

const std::string kData = RDM_TEST_DATA;

void add_settings(std::vector<std::string>& out) {
  const char* const settings[] = {"max_steps=1.5",
                                  "object_mass=0.5..0.25",
                                  "object_mass=1234567.25",
                                  "gravity=-0.0625\nframe_rate=0.5",
                                  "object_mass=0.0625..0.125\nnoise.object.position=0.015625",
                                  "frequency=0.5"};
  for (const char* lines : settings) {
    rdm_pool_config c;
    rdm_pool_config_init(&c, sizeof c);
    c.task = "grasp";
    c.num_envs = 1;
    c.settings = lines;
    rdm_pool* pool = nullptr;
    if (rdm_pool_create(&pool, &c) != RDM_OK) {
      out.emplace_back(rdm_last_error());
      continue;
    }
    out.push_back(written_text(
        [&](char* text, size_t n, size_t* size) { return rdm_pool_get_settings(pool, text, n, size); }));
    rdm_pool_destroy(pool);
  }
}

void add_import(rdm_import* import, std::vector<std::string>& out) {
  rdm_import_note note;
  for (int32_t n = 0; n < rdm_import_note_count(import); ++n) {
    EXPECT_EQ(rdm_import_note_at(import, n, &note), RDM_OK);
    out.emplace_back(note.text);
  }
  rdm_robot_def def;
  rdm_robot_def_init(&def, sizeof def);
  EXPECT_EQ(rdm_import_get_robot_def(import, &def), RDM_OK);
  out.push_back(written_text(
      [&](char* text, size_t n, size_t* size) { return rdm_import_write_robot(&def, text, n, size); }));
  rdm_import_destroy(import);
}

void add_robots(std::vector<std::string>& out) {
  for (const char* file : {"arm.xml", "hand.xml", "hand.urdf", "hand_drives.xml"}) {
    rdm_import* import = nullptr;
    if (rdm_import_read_file(&import, (kData + "/import/" + file).c_str(), nullptr) == RDM_OK)
      add_import(import, out);
    else
      out.emplace_back(rdm_import_error());
  }
  const char* const broken[] = {
      R"(<mujoco><worldbody><body><joint name="a" type="hinge" range="0.5 0.25"/><geom size="0.0125"/></body></worldbody></mujoco>)",
      R"(<robot name="r"><link name="a"><inertial><mass value="0.5"/><inertia ixx="0.125" iyy="0.0625" izz="9.5"/></inertial></link>
<link name="b"><inertial><mass value="0.5"/><inertia ixx="0.125" iyy="0.0625" izz="9.5"/></inertial></link>
<joint name="j" type="revolute"><parent link="a"/><child link="b"/><limit lower="-0.5" upper="0.5" effort="1.5" velocity="2.5"/></joint></robot>)",
  };
  for (const std::string text : broken)
    for (const int32_t mend : {0, 1}) {
      rdm_import_config o;
      rdm_import_config_init(&o, sizeof o);
      o.mend_inertia = mend;
      rdm_import* import = nullptr;
      if (rdm_import_read(&import, text.data(), text.size(), &o) == RDM_OK)
        add_import(import, out);
      else
        out.emplace_back(rdm_import_error());
    }
  rdm_import* arm = nullptr;
  ASSERT_EQ(rdm_import_read_file(&arm, (kData + "/import/arm.xml").c_str(), nullptr), RDM_OK);
  rdm_robot_def def;
  rdm_robot_def_init(&def, sizeof def);
  EXPECT_EQ(rdm_import_get_robot_def(arm, &def), RDM_OK);
  def.root_mass = -0.5;
  int32_t robot = -1;
  EXPECT_NE(rdm_robot_create(&robot, &def), RDM_OK);
  out.emplace_back(rdm_last_error());
  rdm_import_destroy(arm);
}

void add_objects(std::vector<std::string>& out) {
  rdm_object_info object = RDM_INIT(rdm_object_info);
  for (int32_t i = 0; i < rdm_object_count(); ++i)
    if (rdm_object_info_at(i, &object) == RDM_OK)
      out.push_back(std::string(object.name) + ": " + object.shape);
  const std::string text =
      "format = 1\nname = \"locale_ball\"\nmass = 0.0625\n[[shapes]]\nkind = \"capsule\"\nsize = [0.0125, "
      "0.0375]\n";
  rdm_import* import = nullptr;
  if (rdm_import_read_object(&import, text.data(), text.size()) != RDM_OK) {
    out.emplace_back(rdm_import_error());
    return;
  }
  rdm_object_def def;
  rdm_object_def_init(&def, sizeof def);
  EXPECT_EQ(rdm_import_get_object_def(import, &def), RDM_OK);
  out.push_back(written_text(
      [&](char* text, size_t n, size_t* size) { return rdm_import_write_object(&def, text, n, size); }));
  int32_t index = -1;
  EXPECT_EQ(rdm_object_create(&index, &def), RDM_OK) << rdm_last_error();
  if (rdm_object_info_at(index, &object) == RDM_OK) out.emplace_back(object.shape);
  EXPECT_EQ(rdm_object_destroy(index), RDM_OK);
  rdm_import_destroy(import);
}

// The task as text, its options and what it starts from.
void add_task(std::vector<std::string>& out) {
  const std::string file = kData + "/../examples/scenes/press.task";
  int32_t task = -1;
  ASSERT_EQ(rdm_import_read_task_file(&task, file.c_str()), RDM_OK) << rdm_import_error();
  rdm_task t{};
  t.struct_size = sizeof t;
  EXPECT_EQ(rdm_task_at(task, &t), RDM_OK);
  for (int32_t i = 0; i < t.num_fields; ++i) {
    rdm_field_info field = RDM_INIT(rdm_field_info);
    EXPECT_EQ(rdm_task_field_at(task, i, &field), RDM_OK);
    out.push_back(std::string(field.name) + " " + field.unit);
  }
  for (int32_t i = 0; i < t.num_defaults; ++i) {
    rdm_option option;
    EXPECT_EQ(rdm_task_default_at(task, i, &option), RDM_OK);
    out.push_back(std::string(option.key) + "=" + (option.text ? option.text : "-"));
  }
  EXPECT_EQ(rdm_task_destroy(task), RDM_OK);
  const std::string bad = "format = 1\nname = \"x\"\nmax_steps = 2.5\n";
  EXPECT_NE(rdm_import_read_task(&task, bad.data(), bad.size(), "x.task"), RDM_OK);
  out.emplace_back(rdm_import_error());
}

std::vector<std::string> texts() {
  std::vector<std::string> out;
  add_settings(out);
  add_robots(out);
  add_objects(out);
  add_task(out);
  return out;
}

TEST(Locale, ChangesNoText) {
  const std::vector<std::string> plain = texts();
  ASSERT_GT(plain.size(), 20u);
  const CommaLocale locale;
  if (!locale.set()) GTEST_SKIP() << "no locale with a decimal comma is installed, and none can be made";
  const std::vector<std::string> again = texts();
  ASSERT_EQ(again.size(), plain.size());
  for (size_t i = 0; i < plain.size(); ++i) EXPECT_EQ(again[i], plain[i]);
}

}  // namespace
