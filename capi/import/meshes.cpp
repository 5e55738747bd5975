#include "meshes.hpp"

#include <algorithm>
#include <cstring>

namespace rdm::import {

std::string Meshes::resolved(const Element& e, const std::string& written) const {
  std::string name = written;
  const auto plain = [&](const char* scheme) {
    if (name.rfind(scheme, 0) != 0) return false;
    name = name.substr(std::strlen(scheme));
    return true;
  };
  const bool package = plain("package://") || plain("model://");
  if (!package) (void)plain("file://");
  const auto places = [&](const std::string& tail) {
    std::vector<std::string> out;
    if (!package) return std::vector{!tail.empty() && tail[0] == '/' ? tail : options_.folder + tail};
    if (!options_.packages.empty()) out.push_back(options_.packages + '/' + tail);
    std::string up = options_.folder;
    for (int k = 0; k < 8; ++k, up += "../") out.push_back(up + tail);
    return out;
  };
  const auto found = [&](const std::string& tail) -> std::string {
    for (const std::string& place : places(tail))
      if (file_exists(place)) return place;
    return "";
  };
  std::string path = found(name);
  if (path.empty() && name.find('\\') != std::string::npos) {
    std::replace(name.begin(), name.end(), '\\', '/');
    path = found(name);
    if (!path.empty())
      out_->note(RDM_NOTE_CHANGED, e.line, "mesh %s: \\ was read as /", clean(written).c_str());
  }
  if (!path.empty() || !package) return path.empty() ? places(name)[0] : path;
  // Last, without the name of the package: of a folder that was copied alone.
  const size_t slash = name.find('/');
  if (slash != std::string::npos) path = found(name.substr(slash + 1));
  if (!path.empty())
    out_->note(RDM_NOTE_CHANGED, e.line, "mesh %s: no folder %s holds it; %s was taken",
               clean(written).c_str(), clean(name.substr(0, slash)).c_str(), clean(path, 160).c_str());
  return path;
}

const Mesh* Meshes::find(const Element& e, const std::string& name) {
  try {
    if (!options_.has_folder) refuse(RDM_NOT_FOUND, "a text alone has no folder to look in");
    const std::string path = resolved(e, name);
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
