// Pictures: 8-bit RGB in memory, PNG files, and frames for a film made by the ffmpeg program.
#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace tool {

struct Image {
  int32_t width = 0, height = 0;
  std::vector<unsigned char> rgb;  // [height][width][3]
};

// Pictures of one size, left to right, with a thin white line between them inside the given sizes. Each is
// copied as it comes, so that memory holds the strip and one picture.
class PictureRow {
 public:
  explicit PictureRow(int32_t pictures) : pictures_(pictures) {}
  void add(const Image& picture);
  Image take() { return std::move(row_); }

 private:
  Image row_;
  int32_t pictures_, added_ = 0;
};

// Equal widths, with a thin line between them inside the upper one.
Image one_below_the_other(const Image& above, const Image& below);

// A red border inside of it.
void add_border(Image& image);

// The bytes of a PNG file.
std::string png_bytes(const Image& image);
// Replaces the file atomically. Failure when it cannot be written.
void write_png(const std::string& path, const Image& image);

// Frames piped to `ffmpeg`; the ending of the name chooses the kind: .mp4 or .gif.
class Film {
 public:
  // Usage for another ending; Failure when there is no ffmpeg program.
  Film(const std::string& path, int32_t width, int32_t height, double frames_per_second);
  ~Film();
  Film(const Film&) = delete;
  Film& operator=(const Film&) = delete;
  void add(const Image& image);
  void finish();  // waits for ffmpeg; Failure when it failed

 private:
  std::string path_;
  int pipe_ = -1, child_ = -1;
};

}  // namespace tool
