// Names of any script in letters that ids are made of.
#pragma once
#include <string>

namespace rdm::import {

// A UTF-8 text in ASCII: letters with accents without them, Greek, Cyrillic, kana and Hangul by their usual
// romanization, any other letter as its number (u4e2d). Bytes that are no UTF-8 become '_'.
std::string latin(const std::string& text);

}  // namespace rdm::import
