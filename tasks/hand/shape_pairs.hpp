// Lists of pairs of shapes, indices of Scene::pairs: which a task watches, and how many of them touch.
#pragma once
#include "physics/world.hpp"

namespace rdm {

inline int touching(const World& world, const Vector<int32_t>& pairs) {
  int count = 0;
  for (const int32_t pair : pairs) count += world.pair_touched(pair);
  return count;
}

// Pairs of which one shape is of the first kind and the other of the second, by predicates on SceneShape.
template <class A, class B>
Vector<int32_t> pairs_between(const Scene& scene, A&& first, B&& second) {
  Vector<int32_t> out;
  for (size_t i = 0; i < scene.pairs.size(); ++i) {
    const SceneShape &a = scene.shapes[static_cast<size_t>(scene.pairs[i].a)],
                     &b = scene.shapes[static_cast<size_t>(scene.pairs[i].b)];
    if ((first(a) && second(b)) || (first(b) && second(a))) out.push_back(static_cast<int32_t>(i));
  }
  return out;
}

}  // namespace rdm
