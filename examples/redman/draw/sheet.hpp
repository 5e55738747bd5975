// Pictures of all objects, and of robots that nothing drives, side by side.
#pragma once
#include <string>
#include <vector>

#include "draw/image.hpp"

namespace tool {

struct Sheet {
  Image image;
  std::vector<std::string> names;  // row by row
  int32_t columns;
};
// Each stands on the ground in a picture of `side` x `side` pixels; joints are a little open.
Sheet draw_sheet(int32_t side, int32_t columns);

}  // namespace tool
