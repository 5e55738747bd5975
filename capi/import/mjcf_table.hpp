// What of MJCF is read, what is dropped with a note, and what is refused: one table for every element.
//
// An element or attribute that could change mass, pose, axis, range or coupling is read or refused; one that
// the table does not have is refused too.
#pragma once
#include <string>
#include <vector>

#include "xml.hpp"

namespace rdm::import {

enum class Use { kRead, kDropped, kRefused };

struct AttributeRow {
  const char* element;  // "joint" of a body, "fixed/joint" of a tendon
  Use use;
  const char* attributes;  // separated by blanks
  const char* harmless;    // a value that is dropped where others are refused; NULL: none
  const char* why;         // it is refused; NULL
};
struct ElementRow {
  const char* parent;
  Use use;
  const char* children;  // separated by blanks
  const char* why;
};

const std::vector<AttributeRow>& attribute_rows();
const std::vector<ElementRow>& element_rows();

// Refuses an attribute of `e` that the table refuses or does not have; `kind` is its name in the table.
void check_attributes(const Element& e, const std::string& kind);
// The row of an element that stands in a `parent`; refuses what the table does not have.
const ElementRow& row_of(const Element& e, const std::string& parent);
// Refuses an element in `e` that the table refuses or does not have.
void check_children(const Element& e, const std::string& kind);

}  // namespace rdm::import
