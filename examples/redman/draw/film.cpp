#include "draw/image.hpp"

#if defined(_WIN32)
#include "common/report.hpp"

namespace tool {

Film::Film(const std::string&, int32_t, int32_t, double) {
  throw Usage(
      "--video is not available on Windows; use --html or --glb to play the episode, --strip to draw moments "
      "of it");
}
Film::~Film() = default;
void Film::add(const Image&) {}
void Film::finish() {}

}  // namespace tool
#else
#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>

#include "common/files.hpp"
#include "common/report.hpp"
#include "common/text.hpp"

extern char** environ;

namespace tool {
namespace {

// Two ends that no child keeps.
bool pipe_for_us(int ends[2]) {
#if defined(__APPLE__)  // which has no pipe2
  return pipe(ends) == 0 && fcntl(ends[0], F_SETFD, FD_CLOEXEC) == 0 &&
         fcntl(ends[1], F_SETFD, FD_CLOEXEC) == 0;
#else
  return pipe2(ends, O_CLOEXEC) == 0;
#endif
}

}  // namespace

Film::Film(const std::string& path, int32_t width, int32_t height, double frames_per_second) : path_(path) {
  const bool gif = path.ends_with(".gif");
  if (!gif && !path.ends_with(".mp4")) throw Usage("--video " + path + ": it is not a .mp4 or .gif file");
  check_replaceable(path);
  const std::string size = format("%dx%d", width, height), rate = format("%.6g", frames_per_second);
  // one palette for the whole film; an even size is what H.264 needs
  const std::string filter = gif ? "fps=20,split[a][b];[a]palettegen[p];[b][p]paletteuse"
                                 : "pad=ceil(iw/2)*2:ceil(ih/2)*2,format=yuv420p";
  std::vector<std::string> words = {"ffmpeg", "-v", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgb24",
                                    "-s",     size, "-r",    rate, "-i", "-",        "-vf",      filter};
  if (!gif) words.insert(words.end(), {"-c:v", "libx264", "-crf", "18", "-movflags", "+faststart"});
  words.push_back("file:" + path);
  std::vector<char*> arguments;
  for (std::string& w : words) arguments.push_back(w.data());
  arguments.push_back(nullptr);

  std::signal(SIGPIPE, SIG_IGN);  // a write to an ffmpeg that gave up then answers EPIPE
  int ends[2];
  if (!pipe_for_us(ends)) throw Failure(std::string("cannot start ffmpeg: ") + std::strerror(errno));
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[0], STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, STDERR_FILENO, STDOUT_FILENO);
  const int error = posix_spawnp(&child_, "ffmpeg", &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[0]);
  pipe_ = ends[1];
  if (error == 0) return;
  close(pipe_);
  throw Failure(error == ENOENT ? "--video needs the program ffmpeg: install the package ffmpeg"
                                : std::string("cannot start ffmpeg: ") + std::strerror(error));
}

Film::~Film() {
  if (pipe_ >= 0) close(pipe_);
  if (child_ > 0) waitpid(child_, nullptr, 0);
}

void Film::add(const Image& image) {
  for (size_t done = 0; done < image.rgb.size();) {
    const ssize_t n = write(pipe_, image.rgb.data() + done, image.rgb.size() - done);
    if (n < 0 && errno != EINTR) throw Failure("ffmpeg stopped reading while it made " + path_);
    if (n > 0) done += static_cast<size_t>(n);
  }
}

void Film::finish() {
  close(pipe_);
  pipe_ = -1;
  int status = 0;
  waitpid(child_, &status, 0);
  child_ = -1;
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) throw Failure("ffmpeg could not make " + path_);
}

}  // namespace tool
#endif
