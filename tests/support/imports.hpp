// Files read as robots, for the tests of the importer.
#pragma once
#include <gtest/gtest.h>
#include <redman/import.h>

#include <string>
#include <utility>
#include <vector>

struct Import {
  rdm_import* handle = nullptr;
  rdm_robot_def def;
  Import() { rdm_robot_def_init(&def, sizeof def); }
  explicit Import(rdm_import* made) : Import() {
    handle = made;
    if (made) {
      EXPECT_EQ(rdm_import_get_robot_def(handle, &def), RDM_OK) << rdm_import_error();
    }
  }
  Import(Import&& other) noexcept : handle(std::exchange(other.handle, nullptr)), def(other.def) {}
  ~Import() { rdm_import_destroy(handle); }

  int32_t link(const std::string& name) const {
    for (int32_t i = 0; i < def.num_links; ++i)
      if (name == def.links[i].name) return i;
    ADD_FAILURE() << "no link " << name;
    return 0;
  }
  std::vector<std::string> notes(int32_t kind) const {
    std::vector<std::string> out;
    for (int32_t i = 0; i < rdm_import_note_count(handle); ++i) {
      rdm_import_note n;
      EXPECT_EQ(rdm_import_note_at(handle, i, &n), RDM_OK);
      if (n.kind == kind) out.push_back((n.line ? "line " + std::to_string(n.line) + ": " : "") + n.text);
    }
    return out;
  }
  bool has_note(int32_t kind, const std::string& text) const {
    for (const std::string& n : notes(kind))
      if (n.find(text) != std::string::npos) return true;
    return false;
  }
};

inline rdm_import_config import_config() {
  rdm_import_config o;
  EXPECT_EQ(rdm_import_config_init(&o, sizeof o), RDM_OK);
  return o;
}
inline Import from_path(const std::string& path, const rdm_import_config* o = nullptr) {
  rdm_import* i = nullptr;
  EXPECT_EQ(rdm_import_read_file(&i, path.c_str(), o), RDM_OK) << rdm_import_error();
  return Import(i);
}
inline Import from_text(const std::string& text, const rdm_import_config* o = nullptr) {
  rdm_import* i = nullptr;
  EXPECT_EQ(rdm_import_read(&i, text.data(), text.size(), o), RDM_OK) << rdm_import_error();
  return Import(i);
}
// The text is refused with this code, and the error holds these words.
inline void expect_refused(const std::string& text, rdm_result code, const std::string& words,
                           const rdm_import_config* o = nullptr) {
  rdm_import* i = nullptr;
  EXPECT_EQ(rdm_import_read(&i, text.data(), text.size(), o), code) << words << ": " << rdm_import_error();
  EXPECT_NE(std::string(rdm_import_error()).find(words), std::string::npos)
      << "'" << rdm_import_error() << "' is not '" << words << "'";
  rdm_import_destroy(i);
}
