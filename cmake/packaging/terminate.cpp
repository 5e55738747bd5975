// Takes the place of the C++ runtime's handler, which writes what was thrown and for that carries a demangler
// (50 kB of a library that carries the runtime). Nothing is thrown across the C ABI, so nobody reads it.
#include <cstdlib>
#include <exception>

namespace __cxxabiv1 {
extern std::terminate_handler __terminate_handler;
std::terminate_handler __terminate_handler = std::abort;
}  // namespace __cxxabiv1
