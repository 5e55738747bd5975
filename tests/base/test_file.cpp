#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/file.hpp"

namespace rdm {
namespace {

const FileLimits kAny{"", 0, size_t{1} << 26};

// A child that runs `body` and exits with 0 when that is true; how it ended, as waitpid says.
template <class F>
int child(F&& body) {
  const pid_t pid = fork();
  if (pid == 0) _exit(body() ? 0 : 1);
  int status = -1;
  EXPECT_EQ(waitpid(pid, &status, 0), pid);
  return status;
}

class File : public testing::Test {
 protected:
  void SetUp() override {
    folder = std::filesystem::temp_directory_path() / ("redman-file-" + std::to_string(getpid()));
    std::filesystem::create_directory(folder);
    path = folder / "policy.rdm";
  }
  void TearDown() override { std::filesystem::remove_all(folder); }
  std::string content() const {
    const auto bytes = read_file(path.c_str(), kAny);
    return {bytes.begin(), bytes.end()};
  }
  void write(const std::string& text) const { write_file(path.c_str(), text.data(), text.size()); }
  size_t files() const {
    return static_cast<size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
  }
  std::filesystem::path folder, path;
};

TEST_F(File, RoundTrip) {
  std::string all(100000, '\0');
  for (size_t i = 0; i < all.size(); ++i) all[i] = static_cast<char>(i * 7);
  write(all);
  EXPECT_EQ(content(), all);
  write("");
  EXPECT_EQ(content(), "");
  EXPECT_EQ(files(), 1u);
}

TEST_F(File, ReplacingIsByANewFile) {
  write("old");
  struct stat before, after;
  ASSERT_EQ(stat(path.c_str(), &before), 0);
  const std::filesystem::path link = folder / "link";
  std::filesystem::create_hard_link(path, link);
  write("new");
  ASSERT_EQ(stat(path.c_str(), &after), 0);
  EXPECT_NE(before.st_ino, after.st_ino);
  EXPECT_EQ(content(), "new");
  const auto old = read_file(link.c_str(), kAny);  // who held the old file still reads it whole
  EXPECT_EQ(std::string(old.begin(), old.end()), "old");
}

TEST_F(File, WhatIsReplacedKeepsItsPermissions) {
  for (const mode_t mode : {0600u, 0666u, 0640u}) {
    write("old");
    ASSERT_EQ(chmod(path.c_str(), mode), 0);
    write("new");
    struct stat after {};
    ASSERT_EQ(stat(path.c_str(), &after), 0);
    EXPECT_EQ(after.st_mode & 07777, mode);
  }
}

TEST_F(File, WhatMayNotBeWrittenStays) {
  write("old");
  ASSERT_EQ(chmod(path.c_str(), 0444), 0);
  ASSERT_EQ(chmod(folder.c_str(), 0777), 0);
  EXPECT_EQ(child([&] {
              if (geteuid() == 0 && setuid(65534) != 0) return false;  // root may write everything
              return guard([&] { write("new"); }) == Code::kIo &&
                     std::string(last_error()).find("cannot write: Permission denied") != std::string::npos;
            }),
            0);
  EXPECT_EQ(content(), "old");
  EXPECT_EQ(files(), 1u);
}

// A file-size limit refuses the write as a full disk does, part of the way through.
TEST_F(File, FullDiskKeepsTheOldFileAndLeavesNoLitter) {
  write("old");
  for (const bool ignored : {true, false}) {  // SIGXFSZ, which by default ends the process
    EXPECT_EQ(child([&] {
                if (ignored) std::signal(SIGXFSZ, SIG_IGN);
                const rlimit limit{4096, 4096};
                setrlimit(RLIMIT_FSIZE, &limit);
                const std::string big(10000, 'x');
                const Code code = guard([&] { write(big); });
                sigset_t mask, waiting;
                pthread_sigmask(SIG_BLOCK, nullptr, &mask);
                sigpending(&waiting);
                return code == Code::kIo && std::strstr(last_error(), "cannot write: File too large") &&
                       !sigismember(&mask, SIGXFSZ) && !sigismember(&waiting, SIGXFSZ);
              }),
              0)
        << ignored;
    EXPECT_EQ(content(), "old");
    EXPECT_EQ(files(), 1u);
  }
}

// A host that blocks SIGXFSZ and has one waiting keeps both.
TEST_F(File, AHostsOwnSizeSignalIsLeftAlone) {
  EXPECT_EQ(child([&] {
              sigset_t size, mask, waiting;
              sigemptyset(&size);
              sigaddset(&size, SIGXFSZ);
              pthread_sigmask(SIG_BLOCK, &size, nullptr);
              std::raise(SIGXFSZ);
              write("x");
              pthread_sigmask(SIG_BLOCK, nullptr, &mask);
              sigpending(&waiting);
              return sigismember(&mask, SIGXFSZ) && sigismember(&waiting, SIGXFSZ);
            }),
            0);
}

// Killed again and again while it writes; the next writer finds no more than the file itself.
TEST_F(File, WhatKilledWritersLeaveIsSwept) {
  write("old");
  const std::string big(8 << 20, 'x');
  size_t litter = 0;
  for (int round = 0; round < 40 && litter < 2; ++round) {
    const pid_t pid = fork();
    if (pid == 0)
      for (;;) write(big);
    while (files() < 2) usleep(100);
    kill(pid, SIGKILL);
    int status;
    ASSERT_EQ(waitpid(pid, &status, 0), pid);
    litter += files() - 1;
  }
  ASSERT_GT(litter, 0u);
  const auto other = folder / "policy.rdm.tmp-mine";  // not of our making
  std::filesystem::copy_file(path, other);
  write("new");
  EXPECT_EQ(content(), "new");
  EXPECT_EQ(files(), 2u);
  EXPECT_TRUE(std::filesystem::exists(other));
}

// Two writers of one file do not take each other's temporary file for litter.
TEST_F(File, TwoWritersAtOnce) {
  const std::string a(300000, 'a'), b(300000, 'b');
  const pid_t pid = fork();
  const auto work = [&](const std::string& text) {
    for (int i = 0; i < 100; ++i)
      if (guard([&] { write(text); }) != Code::kOk) return false;
    return true;
  };
  if (pid == 0) _exit(work(a) ? 0 : 1);
  EXPECT_TRUE(work(b)) << last_error();
  int status = -1;
  ASSERT_EQ(waitpid(pid, &status, 0), pid);
  EXPECT_EQ(status, 0);
  EXPECT_TRUE(content() == a || content() == b);
  EXPECT_EQ(files(), 1u);
}

TEST_F(File, OnlyRegularFilesAreReplaced) {
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  const auto device = folder / "null", made = folder / "folder", far = folder / "far";
  const bool root = mknod(device.c_str(), S_IFCHR | 0600, makedev(1, 3)) == 0;
  std::filesystem::create_directory(made);
  std::filesystem::create_symlink("policy.rdm", far);  // to the pipe
  const size_t before = files();
  std::vector<std::filesystem::path> targets = {path, made, far};
  if (root) targets.push_back(device);
  for (const auto& target : targets) {
    EXPECT_EQ(guard([&] { write_file(target.c_str(), "x", 1); }), Code::kIo) << target;
    EXPECT_NE(std::string(last_error()).find("not a regular file"), std::string::npos) << last_error();
  }
  EXPECT_TRUE(std::filesystem::is_fifo(path));
  EXPECT_TRUE(std::filesystem::is_directory(made));
  EXPECT_TRUE(std::filesystem::is_symlink(far));
  if (root) {
    EXPECT_TRUE(std::filesystem::is_character_file(device));
  }
  EXPECT_EQ(files(), before);
  for (const auto& target : targets)  // nor waited for
    EXPECT_EQ(guard([&] { read_file(target.c_str(), kAny); }), Code::kIo) << target;
}

TEST_F(File, WhatALinkLeadsToIsReplaced) {
  const auto link = folder / "link", second = folder / "second", inner = folder / "inner";
  std::filesystem::create_directory(inner);
  write("old");
  std::filesystem::create_symlink("policy.rdm", link);
  std::filesystem::create_symlink("../link", inner / "chain");
  std::filesystem::create_symlink(inner / "chain", second);
  for (const auto& through : {link, inner / "chain", second}) {
    const std::string text = through.filename();
    write_file(through.c_str(), text.data(), text.size());
    EXPECT_EQ(content(), text);
    EXPECT_TRUE(std::filesystem::is_symlink(through));
  }
  const auto dangling = folder / "dangling", made = folder / "made";
  std::filesystem::create_symlink("made", dangling);
  write_file(dangling.c_str(), "x", 1);
  EXPECT_TRUE(std::filesystem::is_symlink(dangling) && std::filesystem::is_regular_file(made));
  const auto loop = folder / "loop";
  std::filesystem::create_symlink("loop", loop);
  EXPECT_EQ(guard([&] { write_file(loop.c_str(), "x", 1); }), Code::kIo);
}

// Whoever may write into the folder cannot lead the temporary file elsewhere: not by the name that a process
// of this number used to take, and there is no other that can be known before.
TEST_F(File, APlantedTemporaryFileIsNotFollowed) {
  const auto victim = folder / "victim", trap = folder / ("policy.rdm.tmp-" + std::to_string(getpid()));
  write_file(victim.c_str(), "safe", 4);
  std::filesystem::create_symlink("victim", trap);
  write("x");
  const auto kept = read_file(victim.c_str(), kAny);
  EXPECT_EQ(std::string(kept.begin(), kept.end()), "safe");
  EXPECT_TRUE(std::filesystem::is_symlink(trap));
  EXPECT_EQ(content(), "x");
}

TEST_F(File, LooksBeforeItTakesMemory) {
  write("RDMPOLIC........");
  const FileLimits limits{"RDMPOLIC", 16, 1000};
  EXPECT_EQ(guard([&] { read_file(path.c_str(), limits); }), Code::kOk);  // too short to say its length
  EXPECT_EQ(child([&] {
              const rlimit little{size_t{1} << 30, size_t{1} << 30};
              setrlimit(RLIMIT_AS, &little);
              const auto code = [&](const FileLimits& l) {
                return guard([&] { read_file(path.c_str(), l); });
              };
              const off_t much = off_t{3} << 30;
              bool good = truncate(path.c_str(), much) == 0;
              good = good && code({"RDMCHECK", 0, SIZE_MAX}) == Code::kFormat;   // other first bytes
              good = good && code({"RDMPOLIC", 16, SIZE_MAX}) == Code::kFormat;  // says another length
              good = good && code({"RDMPOLIC", 0, 1000}) == Code::kFormat;       // longer than any
              return good && code({"", 0, 1000, Code::kMemory}) == Code::kMemory;
            }),
            0);
}

TEST_F(File, FailedRenameLeavesNoLitter) {
  std::filesystem::create_directories(path / "in_the_way");
  EXPECT_EQ(guard([&] { write("x"); }), Code::kIo);
  EXPECT_NE(std::string(last_error()).find("policy.rdm"), std::string::npos);
  EXPECT_EQ(files(), 1u);
}

TEST_F(File, MissingAndWrongPaths) {
  EXPECT_EQ(guard([&] { write_file("", "x", 1); }), Code::kArgument);
  EXPECT_STREQ(last_error(), "path: it is empty");
  EXPECT_EQ(guard([&] { read_file(path.c_str(), kAny); }), Code::kNotFound);
  EXPECT_NE(std::string(last_error()).find("policy.rdm"), std::string::npos);
  EXPECT_EQ(guard([&] { read_file(folder.c_str(), kAny); }), Code::kIo);
  EXPECT_EQ(guard([&] { write_file((folder / "none" / "x").c_str(), "x", 1); }), Code::kIo);
  EXPECT_EQ(guard([&] { write_file(std::string(10000, 'a').c_str(), "x", 1); }), Code::kArgument);
  EXPECT_EQ(guard([&] { read_file("/dev/null", kAny); }), Code::kIo);
}

TEST_F(File, RelativeNameWithoutAFolder) {
  const auto back = std::filesystem::current_path();
  std::filesystem::current_path(folder);
  write_file("bare", "here", 4);
  EXPECT_EQ(read_file("bare", kAny).size(), 4u);
  std::filesystem::current_path(back);
}

TEST_F(File, IsReadInPartsToo) {
  write("0123456789");
  const FileSource file(path.c_str());
  EXPECT_EQ(file.size(), 10u);
  char part[4] = {};
  file.read(7, part, 3);
  EXPECT_STREQ(part, "789");
  std::filesystem::resize_file(path, 8);
  EXPECT_THROW(file.read(7, part, 3), Error);
  EXPECT_THROW(FileSource(folder.c_str()), Error);
  const auto pipe = folder / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THROW(FileSource(pipe.c_str()), Error);
}

}  // namespace
}  // namespace rdm
