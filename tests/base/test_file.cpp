#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <string>

#include "base/error.hpp"
#include "base/file.hpp"

namespace rdm {
namespace {

class File : public testing::Test {
 protected:
  void SetUp() override {
    folder = std::filesystem::temp_directory_path() / ("redman-file-" + std::to_string(getpid()));
    std::filesystem::create_directory(folder);
    path = folder / "policy.rdm";
  }
  void TearDown() override { std::filesystem::remove_all(folder); }
  std::string content() const {
    const auto bytes = read_file(path.c_str());
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
  const auto old = read_file(link.c_str());  // who held the old file still reads it whole
  EXPECT_EQ(std::string(old.begin(), old.end()), "old");
}

// A file-size limit refuses the write as a full disk does, part of the way through.
TEST_F(File, FullDiskKeepsTheOldFileAndLeavesNoLitter) {
  write("old");
  const pid_t child = fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{4096, 4096};
    setrlimit(RLIMIT_FSIZE, &limit);
    const std::string big(10000, 'x');
    const Code code = guard([&] { write(big); });
    _exit(code == Code::kIo ? 0 : 1);
  }
  int status = -1;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
  EXPECT_EQ(content(), "old");
  EXPECT_EQ(files(), 1u);
}

TEST_F(File, FailedRenameLeavesNoLitter) {
  std::filesystem::create_directories(path / "in_the_way");
  EXPECT_EQ(guard([&] { write("x"); }), Code::kIo);
  EXPECT_NE(std::string(last_error()).find("policy.rdm"), std::string::npos);
  EXPECT_EQ(files(), 1u);
}

TEST_F(File, MissingAndWrongPaths) {
  EXPECT_EQ(guard([&] { read_file(path.c_str()); }), Code::kNotFound);
  EXPECT_NE(std::string(last_error()).find("policy.rdm"), std::string::npos);
  EXPECT_EQ(guard([&] { read_file(folder.c_str()); }), Code::kIo);
  EXPECT_EQ(guard([&] { write_file((folder / "none" / "x").c_str(), "x", 1); }), Code::kIo);
  EXPECT_EQ(guard([&] { write_file(std::string(10000, 'a').c_str(), "x", 1); }), Code::kArgument);
  EXPECT_EQ(guard([&] { read_file("/dev/null"); }), Code::kIo);
}

TEST_F(File, RelativeNameWithoutAFolder) {
  const auto back = std::filesystem::current_path();
  std::filesystem::current_path(folder);
  write_file("bare", "here", 4);
  EXPECT_EQ(read_file("bare").size(), 4u);
  std::filesystem::current_path(back);
}

}  // namespace
}  // namespace rdm
