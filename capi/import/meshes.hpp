// Mesh files of a robot, each read once.
#pragma once
#include "model.hpp"

namespace rdm::import {

class Meshes {
 public:
  Meshes(const Options& options, Draft* out) : options_(options), out_(out) {}
  // NULL: it cannot be read and options.skip_meshes is set (a note says so); else refused at the element.
  const Mesh* find(const Element& e, const std::string& path);
  // Where "package://hand/meshes/palm.stl" lies: in options.packages, else in the nearest folder above the
  // file that has it; where none has, without the package's name, with a note. "\" is tried as "/". "" when
  // nowhere.
  std::string resolved(const Element& e, const std::string& name) const;

 private:
  const Options& options_;
  Draft* out_;
  std::map<std::string, Mesh> found_;
};

}  // namespace rdm::import
