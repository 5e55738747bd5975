// What the tool does with robots and objects alike: the text of one, and one more in the library's list.
#pragma once
#include <redman/import.h>

#include <string>

#include "common/report.hpp"

namespace tool {

// The library's calls for a kind of things that are described by a Def.
template <class Def>
struct AddedKind {
  const char* noun;  // of the command, and of the files
  rdm_result (*write)(const Def*, char*, size_t, size_t*);
  rdm_result (*create)(int32_t*, const Def*);
  rdm_result (*find)(const char*, int32_t*);
  void (*remember)(const std::string& name, const std::string& text);
};

template <class Def>
std::string text_of(const AddedKind<Def>& kind, const Def& def) {
  size_t size = 0;
  if (kind.write(&def, nullptr, 0, &size) != RDM_OK) throw Failure(rdm_import_error());
  std::string text(size + 1, '\0');
  if (kind.write(&def, text.data(), text.size(), &size) != RDM_OK) throw Failure(rdm_import_error());
  text.pop_back();
  return text;
}

// `where` is the file, and begins what is wrong.
template <class Def>
int32_t add(const AddedKind<Def>& kind, const Def& def, const std::string& where) {
  int32_t index = -1, taken = -1;
  if (kind.create(&index, &def) != RDM_OK) {
    std::string text = where + ": " + rdm_last_error();
    if (kind.find(def.name, &taken) == RDM_OK || (def.alias && kind.find(def.alias, &taken) == RDM_OK)) {
      const std::string noun = kind.noun;
      text += ": give it another by redman " + noun + ' ' + where + " --name NAME --out NAME." + noun +
              ", and take that file";
    }
    throw Failure(text);
  }
  kind.remember(def.name, text_of(kind, def));
  return index;
}

}  // namespace tool
