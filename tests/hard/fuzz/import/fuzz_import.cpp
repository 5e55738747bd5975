// Robots' files: URDF, MJCF and text. What is read can be made, written, and read back to the same text; what
// is not is refused with a text. And objects as text. The first byte says as what the rest is read.
#include <redman/import.h>

#include <cstring>

#include "../fuzz.hpp"

namespace hard {
namespace {

const char kUrdf[] =
    "<robot name=\"r\"><link name=\"a\"/><joint name=\"j\" type=\"revolute\"><parent link=\"a\"/><child "
    "link=\"b\"/>"
    "<origin xyz=\"0 0 1\" rpy=\"0 1 0\"/><axis xyz=\"0 0 1\"/><limit lower=\"0\" upper=\"1\" effort=\"1\" "
    "velocity=\"1\"/>"
    "</joint><link name=\"b\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" "
    "izz=\"1\"/></inertial>"
    "<collision><geometry><box size=\"1 1 1\"/></geometry></collision></link><joint name=\"k\" "
    "type=\"continuous\">"
    "<parent link=\"b\"/><child link=\"c\"/><mimic joint=\"j\" multiplier=\"2\" "
    "offset=\"0.1\"/></joint><link name=\"c\">"
    "<inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\"/></inertial></link></robot>";
const char kMjcf[] =
    "<mujoco><compiler angle=\"radian\"/><default><geom density=\"10\"/><default class=\"c\"><joint "
    "range=\"0 1\"/></default>"
    "</default><worldbody><body name=\"a\" childclass=\"c\"><geom size=\"1\"/><body name=\"b\" pos=\"0 0 1\" "
    "euler=\"0 1 0\">"
    "<joint name=\"j\" axis=\"0 1 0\"/><geom type=\"capsule\" fromto=\"0 0 0 0 0 1\" size=\"0.1\"/><body "
    "name=\"d\">"
    "<joint name=\"k\" type=\"slide\" ref=\"0.1\"/><geom type=\"box\" size=\"1 1 "
    "1\"/></body></body></body></worldbody>"
    "<tendon><fixed name=\"t\"><joint joint=\"j\" coef=\"1\"/><joint joint=\"k\" "
    "coef=\"2\"/></fixed></tendon><actuator>"
    "<position tendon=\"t\" kp=\"3\" ctrlrange=\"0 1\"/></actuator><keyframe><key qpos=\"0.1 "
    "0.1\"/></keyframe></mujoco>";

std::string written(const rdm_robot_def& def) {
  size_t size = 0;
  HARD_REQUIRE(rdm_import_write_robot(&def, nullptr, 0, &size) == RDM_OK, "%s", rdm_import_error());
  std::string text(size + 1, '\0');
  HARD_REQUIRE(rdm_import_write_robot(&def, text.data(), text.size(), &size) == RDM_OK, "%s",
               rdm_import_error());
  text.pop_back();
  return text;
}

rdm_robot_def def_of(const rdm_import* i) {
  rdm_robot_def def;
  rdm_robot_def_init(&def, sizeof def);
  HARD_REQUIRE(rdm_import_get_robot_def(i, &def) == RDM_OK, "%s", rdm_import_error());
  return def;
}

// What the first byte says for an .object file, behind the formats of robots.
constexpr int kObject = RDM_IMPORT_ROBOT + 1;

std::string written(const rdm_import* i) {
  rdm_object_def def;
  rdm_object_def_init(&def, sizeof def);
  HARD_REQUIRE(rdm_import_get_object_def(i, &def) == RDM_OK, "%s", rdm_import_error());
  size_t size = 0;
  HARD_REQUIRE(rdm_import_write_object(&def, nullptr, 0, &size) == RDM_OK, "%s", rdm_import_error());
  std::string text(size + 1, '\0');
  HARD_REQUIRE(rdm_import_write_object(&def, text.data(), text.size(), &size) == RDM_OK, "%s",
               rdm_import_error());
  text.pop_back();
  return text;
}

void one_object(const unsigned char* data, size_t size) {
  rdm_import *i = nullptr, *again = nullptr;
  const rdm_result r = rdm_import_read_object(&i, data, size);
  if (r != RDM_OK) {
    HARD_REQUIRE(i == nullptr && rdm_import_error()[0] != 0 && r != RDM_ERROR_INTERNAL, "%d %s", r,
                 rdm_import_error());
    return;
  }
  const std::string text = written(i);
  HARD_REQUIRE(rdm_import_read_object(&again, text.data(), text.size()) == RDM_OK, "%s", rdm_import_error());
  HARD_REQUIRE(written(again) == text, "an object does not read back");
  rdm_import_destroy(again);
  rdm_import_destroy(i);
}

}  // namespace

std::vector<Bytes> seeds() {
  std::vector<Bytes> out{with_pick(RDM_IMPORT_URDF, bytes_of(kUrdf)),
                         with_pick(RDM_IMPORT_MJCF, bytes_of(kMjcf))};
  for (const char* text : {kUrdf, kMjcf}) {
    rdm_import* i = nullptr;
    HARD_REQUIRE(rdm_import_read(&i, text, std::strlen(text), nullptr) == RDM_OK, "%s", rdm_import_error());
    out.push_back(with_pick(RDM_IMPORT_ROBOT, bytes_of(written(def_of(i)))));
    rdm_import_destroy(i);
  }
  for (const char* name : {"mug_with_handle", "banana"}) {
    int32_t object = -1;
    rdm_import* i = nullptr;
    HARD_REQUIRE(rdm_object_find(name, &object) == RDM_OK && rdm_import_create_object(&i, object) == RDM_OK,
                 "%s", name);
    out.push_back(with_pick(kObject, bytes_of(written(i))));
    rdm_import_destroy(i);
  }
  return out;
}
void whole(unsigned char*, size_t) {}
size_t fixed_bytes() {
  return 0;
}

void one(const unsigned char* data, size_t size) {
  rdm_import_config o;
  rdm_import_config_init(&o, sizeof o);
  const int format = static_cast<int>(pick(data, size, 5));
  if (format == kObject) return one_object(size ? data + 1 : data, size ? size - 1 : 0);
  o.format = format;
  o.skip_meshes = o.mend_inertia = size > 0 && data[0] >= 128;
  rdm_import* i = nullptr;
  const rdm_result r = rdm_import_read(&i, size ? data + 1 : data, size ? size - 1 : 0, &o);
  if (r != RDM_OK) {
    HARD_REQUIRE(i == nullptr && rdm_import_error()[0] != 0 && r != RDM_ERROR_INTERNAL, "%d %s", r,
                 rdm_import_error());
    return;
  }
  const std::string text = written(def_of(i));
  rdm_import* again = nullptr;
  HARD_REQUIRE(rdm_import_read(&again, text.data(), text.size(), nullptr) == RDM_OK, "%s",
               rdm_import_error());
  HARD_REQUIRE(written(def_of(again)) == text, "a robot does not read back");
  rdm_import_note note;
  for (int32_t n = 0; n < rdm_import_note_count(i); ++n)
    HARD_REQUIRE(rdm_import_note_at(i, n, &note) == RDM_OK && note.text && !std::strchr(note.text, '\n'),
                 "a note");
  if (def_of(i).num_links <= 4) HARD_REQUIRE(rdm_import_check(again) == RDM_OK, "%s", rdm_import_error());
  rdm_import_destroy(again);
  rdm_import_destroy(i);
}

}  // namespace hard
