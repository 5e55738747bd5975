#include "base/lasting.hpp"

#include <mutex>
#include <set>
#include <string>
#include <string_view>

namespace rdm {

const char* lasting(const char* text) {
  struct Texts {
    std::mutex mutex;
    std::set<std::string, std::less<>> all;
  };
  static auto* const texts = new Texts;  // never ended: they are still read while the process ends
  if (!text) return nullptr;
  const std::lock_guard lock(texts->mutex);
  const auto known = texts->all.find(std::string_view(text));
  return known != texts->all.end() ? known->c_str() : texts->all.emplace(text).first->c_str();
}

}  // namespace rdm
