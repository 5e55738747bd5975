#include "meshes.hpp"

#include <algorithm>
#include <cstring>

namespace rdm::import {

// "package://hand/meshes/palm.stl" lies in options.packages, else in the nearest folder above the file that
// has it; where none has, without the package's name, with a note. "\" is tried as "/". "" when nowhere.
std::string Meshes::found(const Element& e, const std::string& written) {
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
  const auto there = [&](const std::string& tail) -> std::string {
    for (const std::string& place : places(tail))
      if (file_exists(place)) return place;
    return "";
  };
  std::string path = there(name);
  if (path.empty() && name.find('\\') != std::string::npos) {
    std::replace(name.begin(), name.end(), '\\', '/');
    path = there(name);
    if (!path.empty())
      out_->note(RDM_NOTE_CHANGED, e.line, "mesh %s: \\ was read as /", clean(written).c_str());
  }
  if (!path.empty() || !package) return path.empty() ? places(name)[0] : path;
  // Last, without the name of the package: of a folder that was copied alone.
  const size_t slash = name.find('/');
  if (slash != std::string::npos) path = there(name.substr(slash + 1));
  if (!path.empty())
    out_->note(RDM_NOTE_CHANGED, e.line, "mesh %s: there is no folder %s with it; %s was used",
               clean(written).c_str(), clean(name.substr(0, slash)).c_str(), clean(path, 160).c_str());
  return path;
}

const std::string& Meshes::place(const Element& e, const std::string& name) {
  const auto [at, added] = places_.try_emplace(name);
  if (added) {
    out_->budget.spend(Cost::kFiles, 1);
    at->second = found(e, name);
  }
  return at->second;
}

const Mesh* Meshes::find(const Element& e, const std::string& name) {
  try {
    if (!options_.has_folder)
      refuse(RDM_ERROR_NOT_FOUND, "a text that is not from a file has no folder to search");
    const std::string& path = place(e, name);
    if (path.empty()) refuse(RDM_ERROR_NOT_FOUND, "it was not found in the folders above the file");
    if (path != last_) {
      last_.clear();
      mesh_ = {};
      mesh_ = read_mesh(path, &out_->budget);
      last_ = path;
    }
    out_->budget.spend(Cost::kCorners, mesh_.points.size() + mesh_.faces.size());
    return &mesh_;
  } catch (const Refusal& r) {
    std::string hint;
    if (name.find('\\') != std::string::npos) hint = " (a path is written with /, not \\)";
    if (!options_.skip_meshes)
      refuse_at(r.code, e, "mesh %s: %s%s", clean(name).c_str(), r.text.c_str(), hint.c_str());
    out_->note(RDM_NOTE_DROPPED, e.line, "mesh %s: %s%s", clean(name).c_str(), r.text.c_str(), hint.c_str());
    return nullptr;
  }
}

}  // namespace rdm::import
