// An object that owns its tables and its names: what a host describes while the program runs.
#pragma once
#include "objects/object.hpp"

namespace rdm {

class ObjectCopy {
 public:
  explicit ObjectCopy(const Object& object);  // deep
  ObjectCopy(const ObjectCopy&) = delete;
  ObjectCopy& operator=(const ObjectCopy&) = delete;

  const Object& object() const { return object_; }

 private:
  const char* keep(const char* text);  // null stays null

  Object object_;
  Vector<ObjectShape> shapes_;
  Vector<Vector<Vec3>> points_;
  Vector<Vector<char>> texts_;
};

// "box 0.05 x 0.05 x 0.05", of several shapes "2 capsules, 1 box": as Object::shape_text, into `size` bytes.
void write_shape_text(const Object& object, char* out, size_t size);

}  // namespace rdm
