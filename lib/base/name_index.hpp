// Rows found by their name in one look, where names match as in same_name: a hash table with open addresses.
// Whoever has the rows keeps their names, and the slots: a power of two of them, at least twice as many as
// rows, all zero at first.
#pragma once
#include <cstdint>

#include "base/names.hpp"

namespace rdm {

struct NameSlot {
  uint16_t tag;   // of the name's hash
  uint16_t next;  // the row and 1, 0: free
};
inline constexpr size_t kMostIndexed = UINT16_MAX - 1;  // rows

// FNV-1a (Fowler, Noll, Vo) of the folded letters.
inline uint32_t hash_name(const char* name) {
  uint32_t h = 2166136261u;
  for (; *name; ++name) h = (h ^ static_cast<uint8_t>(fold_letter(*name))) * 16777619u;
  return h;
}
inline uint16_t tag_of(uint32_t hash) {
  return static_cast<uint16_t>(hash >> 16);
}

// name_of(row) is its name; -1: there is none of this name.
template <class NameOf>
int32_t find_indexed(const NameSlot* slots, size_t count, const char* name, const NameOf& name_of) {
  if (count == 0) return -1;
  const uint32_t hash = hash_name(name);
  for (size_t at = hash & (count - 1); slots[at].next != 0; at = (at + 1) & (count - 1))
    if (slots[at].tag == tag_of(hash) && same_name(name_of(slots[at].next - 1), name))
      return slots[at].next - 1;
  return -1;
}
inline void add_indexed(NameSlot* slots, size_t count, const char* name, int32_t row) {
  const uint32_t hash = hash_name(name);
  size_t at = hash & (count - 1);
  while (slots[at].next != 0) at = (at + 1) & (count - 1);
  slots[at] = {tag_of(hash), static_cast<uint16_t>(row + 1)};
}

}  // namespace rdm
