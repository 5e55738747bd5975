#include "meshes.hpp"

namespace rdm::import {

std::string Meshes::resolved(const std::string& name) const {
  const std::string scheme = "package://", file = "file://";
  if (name.rfind(file, 0) == 0) return name.substr(file.size());
  if (name.rfind(scheme, 0) != 0) return !name.empty() && name[0] == '/' ? name : options_.folder + name;
  const std::string whole = name.substr(scheme.size());
  const size_t slash = whole.find('/');
  const std::string rest = slash == std::string::npos ? whole : whole.substr(slash + 1);
  std::vector<std::string> places;
  if (!options_.packages.empty()) places.push_back(options_.packages + '/');
  std::string up = options_.folder;
  for (int k = 0; k < 8; ++k, up += "../") places.push_back(up);
  for (const std::string& place : places) {
    for (const std::string& tail : {whole, rest})
      if (file_exists(place + tail)) return place + tail;
  }
  return "";
}

const Mesh* Meshes::find(const Element& e, const std::string& name) {
  try {
    if (!options_.has_folder) refuse(RDM_NOT_FOUND, "a text alone has no folder to look in");
    const std::string path = resolved(name);
    if (path.empty()) refuse(RDM_NOT_FOUND, "not found in the folders above the file");
    const auto known = found_.find(path);
    if (known != found_.end()) return &known->second;
    return &(found_[path] = read_mesh(path));
  } catch (const Refusal& r) {
    if (!options_.skip_meshes) refuse_at(r.code, e, "mesh %s: %s", clean(name).c_str(), r.text.c_str());
    out_->note(RDM_NOTE_DROPPED, e.line, "mesh %s: %s", clean(name).c_str(), r.text.c_str());
    return nullptr;
  }
}

}  // namespace rdm::import
