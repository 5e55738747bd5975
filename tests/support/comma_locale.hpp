// Sets a locale with a decimal comma while it lives: one that is installed, or de_DE as localedef makes it in a
// folder of its own.
#pragma once
#include <stdlib.h>

#include <clocale>
#include <cstring>
#include <filesystem>
#include <string>

class CommaLocale {
 public:
  CommaLocale() {
    for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "pl_PL.UTF-8", "de_DE", "German"})
      if (!set_) set_ = try_name(name);
    if (!set_) set_ = make();
  }
  ~CommaLocale() {
    std::setlocale(LC_ALL, "C");
    std::error_code error;
    if (!folder_.empty()) std::filesystem::remove_all(folder_, error);
  }
  CommaLocale(const CommaLocale&) = delete;
  CommaLocale& operator=(const CommaLocale&) = delete;
  bool set() const { return set_; }

 private:
  static bool try_name(const char* name) {
    return std::setlocale(LC_ALL, name) && std::strcmp(std::localeconv()->decimal_point, ".") != 0;
  }
  bool make() {
#if defined(_WIN32)
    return false;
#else
    char pattern[] = "/tmp/redman-locale-XXXXXX";
    const char* folder = mkdtemp(pattern);
    if (!folder) return false;
    folder_ = folder;
    // a warning is no failure: what counts is whether the locale can be set
    const std::string command =
        "localedef -i de_DE -f UTF-8 " + folder_ + "/de_DE.UTF-8 > " + folder_ + "/log 2>&1";
    if (std::system(command.c_str()) < 0) return false;
    setenv("LOCPATH", folder_.c_str(), 1);
    return try_name("de_DE.UTF-8");
#endif
  }
  std::string folder_;
  bool set_ = false;
};
