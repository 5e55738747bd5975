// Objects of the tool's user: .object files that become objects of the library, by --object or `redman
// object`.
#pragma once
#include <redman/import.h>

#include <string>
#include <vector>

#include "common/robots.hpp"

namespace tool {

// Failure with line and key. Or, for the name of an object that is there and no file, that object.
Import import_object(const std::string& file);
// The same of an .object file's text; `where` begins what is wrong with it.
Import import_object_text(const std::string& text, const std::string& where);
rdm_object_def object_def_of(const Import& import);
// The file's object, added to those of the process; 0 and up.
int32_t load_object(const std::string& file);
int32_t load_object_text(const std::string& text, const std::string& where);  // of an .object file
// As an .object file.
std::string object_text(const rdm_object_def& def);
std::vector<std::string> object_names();

// --object FILE, repeatable: loads them while the command line is read, before any task is made.
void add_object_flag(CLI::App& command);
const std::vector<std::string>& given_objects();  // the files that were given so

}  // namespace tool
