// redman/base.hpp: what all owners share: Error, views, handles. C++17, stable since 1.0.
//
// Everything throws redman::Error, with the code and the text of the library. A build without
// exceptions defines REDMAN_THROW(error) before the first #include, as something that does not
// return:
//   #define REDMAN_THROW(error) my_panic((error).what())
#ifndef REDMAN_BASE_HPP
#define REDMAN_BASE_HPP
#include <redman/base.h>

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#if !defined(REDMAN_THROW)
#if !defined(__cpp_exceptions)
#error "a build without exceptions: define REDMAN_THROW(error) as something that does not return"
#endif
#define REDMAN_THROW(error) throw error
#endif

namespace redman {

// A failed call: code() is the rdm_result, what() the library's line of text.
class Error : public std::runtime_error {
 public:
  Error(rdm_result code, const std::string& text) : std::runtime_error(text), code_(code) {}
  rdm_result code() const noexcept { return code_; }

 private:
  rdm_result code_;
};

// Throws Error with this thread's text unless r is RDM_OK.
inline void check(rdm_result r) {
  if (r != RDM_OK) REDMAN_THROW(Error(r, rdm_last_error()));
}

// A borrowed run of values: pointer and count.
template <class T>
class View {
 public:
  View(T* data, size_t size) : data_(data), size_(size) {}
  T* data() const { return data_; }
  size_t size() const { return size_; }
  T* begin() const { return data_; }
  T* end() const { return data_ + size_; }
  T& operator[](size_t i) const { return data_[i]; }

 private:
  T* data_ = nullptr;
  size_t size_ = 0;
};

// A borrowed row-major table: operator[] is a row.
template <class T>
class Rows {
 public:
  Rows(T* data, size_t rows, size_t width) : data_(data), rows_(rows), width_(width) {}
  T* data() const { return data_; }
  size_t width() const { return width_; }
  View<T> operator[](size_t row) const { return {data_ + row * width_, width_}; }

 private:
  T* data_ = nullptr;
  size_t rows_ = 0, width_ = 0;
};

// Owns a handle; made() turns a create call into one.
template <auto kDestroy>
struct Destroy {
  template <class T>
  void operator()(T* handle) const {
    kDestroy(handle);
  }
};
template <class T, void (*kDestroy)(T*)>
using Handle = std::unique_ptr<T, Destroy<kDestroy>>;
template <class T, class... Args>
T* made(rdm_result (*create)(T**, Args...), Args... args) {
  T* handle = nullptr;
  check(create(&handle, args...));
  return handle;
}

using Bytes = std::vector<unsigned char>;

// A text of a function that is called for its size first, such as rdm_pool_get_settings.
template <class T>
std::string text_of(rdm_result (*write)(const T*, char*, size_t, size_t*), const T* handle) {
  size_t size = 0;
  check(write(handle, nullptr, 0, &size));
  std::string text(size + 1, '\0');
  check(write(handle, text.data(), text.size(), &size));
  text.resize(size);
  return text;
}

// Bytes of a function that is called for their size first: a state, a policy file.
template <class T>
Bytes bytes_of(rdm_result (*write)(const T*, void*, size_t, size_t*), const T* handle) {
  size_t size = 0;
  check(write(handle, nullptr, 0, &size));
  Bytes bytes(size);
  check(write(handle, bytes.data(), bytes.size(), &size));
  return bytes;
}

// A struct with struct_size set and everything else 0.
template <class T>
T sized() {
  T value{};
  value.struct_size = sizeof(T);
  return value;
}

}  // namespace redman
#endif
