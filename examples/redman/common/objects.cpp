#include "common/objects.hpp"

#include <CLI/CLI.hpp>
#include <filesystem>
#include <redman/redman.hpp>

#include "common/added.hpp"
#include "common/files.hpp"
#include "common/names.hpp"
#include "common/report.hpp"
#include "common/task_files.hpp"

namespace tool {

std::vector<std::string> object_names() {
  std::vector<std::string> names;
  for (int32_t i = 0; i < rdm_object_count(); ++i) {
    rdm_object_info object = RDM_INIT(rdm_object_info);  // one that was destroyed leaves its number
    if (rdm_object_info_at(i, &object) == RDM_OK) names.emplace_back(object.name);
  }
  return names;
}

#ifdef REDMAN_IMPORT
namespace {
std::string hint_of(const std::string& file) {
  const std::string hint = nearest_hint(file, object_names());
  return hint.empty() ? missing_file_hint(file) : hint;
}
}  // namespace

Import import_object(const std::string& file) {
  rdm_import* made = nullptr;
  int32_t known = -1;
  if (!file_exists(file) && file.find('/') == std::string::npos) {
    if (rdm_object_find(file.c_str(), &known) != RDM_OK) {
      std::error_code error;
      if (std::filesystem::exists(file, error)) throw Failure(file + ": it is not a regular file");
      throw Failure(file + ": there is no such file, and no object of that name" + hint_of(file));
    }
    if (rdm_import_create_object(&made, known) != RDM_OK) throw Failure(rdm_import_error());
  } else if (rdm_import_read_object_file(&made, file.c_str()) != RDM_OK) {
    throw Failure(rdm_import_error());
  }
  return Import(made);
}

Import import_object_text(const std::string& text, const std::string& where) {
  rdm_import* made = nullptr;
  if (rdm_import_read_object(&made, text.data(), text.size()) != RDM_OK)
    throw Failure(where + ": " + rdm_import_error());
  return Import(made);
}

rdm_object_def object_def_of(const Import& import) {
  rdm_object_def def;
  rdm_object_def_init(&def, sizeof def);
  if (rdm_import_get_object_def(import.get(), &def) != RDM_OK) throw Failure(rdm_import_error());
  return def;
}

namespace {
constexpr AddedKind<rdm_object_def> kObject = {"object", rdm_import_write_object, rdm_object_create,
                                               rdm_object_find, remember_object};
}  // namespace

std::string object_text(const rdm_object_def& def) {
  return text_of(kObject, def);
}
int32_t load_object(const std::string& file) {
  return add(kObject, object_def_of(import_object(file)), file);
}
int32_t load_object_text(const std::string& text, const std::string& where) {
  return add(kObject, object_def_of(import_object_text(text, where)), where);
}
#else
Import import_object(const std::string&) {
  without_readers();
}
Import import_object_text(const std::string&, const std::string&) {
  without_readers();
}
rdm_object_def object_def_of(const Import&) {
  without_readers();
}
std::string object_text(const rdm_object_def&) {
  without_readers();
}
int32_t load_object(const std::string&) {
  without_readers();
}
int32_t load_object_text(const std::string&, const std::string&) {
  without_readers();
}
#endif

namespace {
std::vector<std::string> g_object_files;  // as the list of objects itself, of the process
}  // namespace

const std::vector<std::string>& given_objects() {
  return g_object_files;
}

void add_object_flag(CLI::App& command) {
  command
      .add_option_function<std::vector<std::string>>(
          "--object",
          [](const std::vector<std::string>& files) {
            for (const std::string& file : files) {
              load_object(file);
              g_object_files.push_back(file);
            }
          },
          "file of an object (.object, written by redman object) for --set object=NAME; repeatable")
      ->allow_extra_args(false)
      ->type_name("FILE")
      ->group(kOwnGroup);
}

}  // namespace tool
