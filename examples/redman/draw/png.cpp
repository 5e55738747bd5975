#include <png.h>

#include <algorithm>

#include "common/files.hpp"
#include "common/report.hpp"
#include "draw/image.hpp"

namespace tool {
namespace {
constexpr int32_t kLine = 2;  // pixels
}  // namespace

Image side_by_side(const std::vector<Image>& images) {
  Image out;
  for (const Image& i : images) {
    out.width += i.width;
    out.height = std::max(out.height, i.height);
  }
  out.rgb.resize(static_cast<size_t>(out.width) * static_cast<size_t>(out.height) * 3, 255);
  size_t left = 0;
  for (const Image& i : images) {
    const auto drawn = static_cast<size_t>(&i == &images.back() ? i.width : std::max(i.width - kLine, 0));
    for (size_t y = 0; y < static_cast<size_t>(i.height); ++y)
      std::copy_n(
          i.rgb.begin() + static_cast<std::ptrdiff_t>(y * static_cast<size_t>(i.width) * 3), drawn * 3,
          out.rgb.begin() + static_cast<std::ptrdiff_t>((y * static_cast<size_t>(out.width) + left) * 3));
    left += static_cast<size_t>(i.width);
  }
  return out;
}

Image one_below_the_other(const Image& above, const Image& below) {
  Image out{above.width, above.height + below.height, above.rgb};
  const auto row = static_cast<size_t>(above.width) * 3;
  std::fill(out.rgb.end() - static_cast<std::ptrdiff_t>(std::min(row * kLine, out.rgb.size())), out.rgb.end(),
            static_cast<unsigned char>(255));
  out.rgb.insert(out.rgb.end(), below.rgb.begin(), below.rgb.end());
  return out;
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
