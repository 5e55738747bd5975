#include <png.h>

#include <algorithm>

#include "common/files.hpp"
#include "common/report.hpp"
#include "draw/image.hpp"

namespace tool {
namespace {
constexpr size_t kLine = 2;  // pixels
}  // namespace

void PictureRow::add(const Image& picture) {
  const auto width = static_cast<size_t>(picture.width), height = static_cast<size_t>(picture.height),
             whole = width * static_cast<size_t>(pictures_);
  if (added_ == 0) {
    row_ = {picture.width * pictures_, picture.height, {}};
    row_.rgb.resize(whole * height * 3, 255);
  }
  const bool last = added_ + 1 == pictures_;
  const size_t drawn = last ? width : width - std::min(width, size_t{kLine});
  const size_t left = width * static_cast<size_t>(added_++);
  for (size_t y = 0; y < height; ++y)
    std::copy_n(picture.rgb.data() + y * width * 3, drawn * 3, row_.rgb.data() + (y * whole + left) * 3);
}

Image one_below_the_other(const Image& above, const Image& below) {
  Image out{above.width, above.height + below.height, above.rgb};
  const auto row = static_cast<size_t>(above.width) * 3;
  std::fill(out.rgb.end() - static_cast<std::ptrdiff_t>(std::min(row * kLine, out.rgb.size())), out.rgb.end(),
            static_cast<unsigned char>(255));
  out.rgb.insert(out.rgb.end(), below.rgb.begin(), below.rgb.end());
  return out;
}

void add_border(Image& image) {
  constexpr unsigned char kRed[3] = {208, 0, 0};
  const int32_t w = image.width, h = image.height, wide = std::max(4, std::min(w, h) / 60);
  for (int32_t y = 0; y < h; ++y)
    for (int32_t x = 0; x < w; ++x)
      if (std::min({x, y, w - 1 - x, h - 1 - y}) < wide)
        std::copy_n(kRed, 3,
                    image.rgb.data() +
                        3 * (static_cast<size_t>(y) * static_cast<size_t>(w) + static_cast<size_t>(x)));
}

std::string png_bytes(const Image& image) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::string bytes(size, '\0');
  if (!png_image_write_to_memory(&png, bytes.data(), &size, 0, image.rgb.data(), 0, nullptr))
    throw Failure(std::string("cannot make a picture: ") + png.message);
  bytes.resize(size);
  return bytes;
}

void write_png(const std::string& path, const Image& image) {
  replace_file(path, png_bytes(image));
}

}  // namespace tool
