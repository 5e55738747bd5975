// Mesh files of a robot: where their names lead, and what is in them.
#pragma once
#include "model.hpp"

namespace rdm::import {

class Meshes {
 public:
  Meshes(const Options& options, Draft* out) : options_(options), out_(out) {}
  // Valid until the next call. NULL: it cannot be read and options.skip_meshes is set (a note says so); else
  // refused at the element.
  const Mesh* find(const Element& e, const std::string& name);

 private:
  const std::string& place(const Element& e, const std::string& name);
  std::string found(const Element& e, const std::string& name);
  const Options& options_;
  Draft* out_;
  std::map<std::string, std::string> places_;  // of names; "" for nowhere
  std::string last_;                           // whose mesh it is: one alone is kept, as they are large
  Mesh mesh_;
};

}  // namespace rdm::import
