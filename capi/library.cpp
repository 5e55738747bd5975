// Version, build, results, and process-wide hooks.
#include <cmath>
#include <cstdio>
#include <cstring>
#include <mutex>

#include "base/names.hpp"
#include "base/text.hpp"
#include "base/vec.hpp"
#include "capi/abi_call.hpp"
#if RDM_WITH_POLICY
#include "nn/kernels.hpp"
#endif
#if RDM_WITH_SIM
#include "physics/collision/known_bytes.hpp"
#endif

using namespace rdm;
using namespace rdm::capi;

#define RDM_TEXT_OF(x) #x
#define RDM_TEXT_OF_VALUE(x) RDM_TEXT_OF(x)

namespace {
std::mutex g_init_mutex;
int32_t g_init_count = 0;
bool g_init_hooks = false;
}  // namespace

const char* rdm_result_string(rdm_result r) {
  return code_string(r);
}
const char* rdm_last_error(void) {
  return last_error();
}

rdm_result rdm_nearest_names(const char* name, const char* names, char* text, size_t capacity) {
  return call([&] {
    need(name, "name");
    need(names, "names");
    need(text, "text");
    if (capacity == 0) fail(Code::kArgument, "capacity: 0 bytes cannot hold a text");
    Vector<char> lines(names, names + std::strlen(names) + 1);
    Vector<const char*> rows;
    for (char* at = lines.data(); *at && rows.size() < static_cast<size_t>(Nearest::kMostLookedAt);) {
      char* end = at + std::strcspn(at, "\n");
      rows.push_back(at);
      at = *end ? end + 1 : end;
      *end = '\0';
    }
    clean_text(text, capacity, Nearest(name, rows.data(), static_cast<int32_t>(rows.size())).text);
  });
}
rdm_result rdm_fail(rdm_result code, const char* text) {
  return call_inside([&] {
    need(text, "text");
    if ((code > static_cast<rdm_result>(RDM_ERROR_ARGUMENT) ||
         code < static_cast<rdm_result>(RDM_ERROR_CANCELLED)) &&
        code != static_cast<rdm_result>(RDM_ERROR_INTERNAL))
      fail(Code::kRange, "code: %d is not the code of an error; the text was: %s", code, text);
    fail(static_cast<Code>(code), "%s", text);
  });
}

rdm_result rdm_rotation(const double axis[3], double angle, double q[4]) {
  return call_inside([&] {
    need(axis, "axis");
    need(q, "q");
    const Vec3 a{axis[0], axis[1], axis[2]};
    if (!finite(a) || !(std::fabs(norm(a) - 1) < 1e-4)) fail(Code::kArgument, "axis is not a unit vector");
    if (!std::isfinite(angle)) fail(Code::kArgument, "angle is not finite");
    const Quat turn = axis_angle(a, angle);
    q[0] = turn.x, q[1] = turn.y, q[2] = turn.z, q[3] = turn.w;
  });
}

uint32_t rdm_version(void) {
  return RDM_VERSION;
}
uint32_t rdm_features(void) {
  uint32_t f = 0;
  if (RDM_WITH_SIM) f |= RDM_FEATURE_SIM;
  if (RDM_WITH_LEARN) f |= RDM_FEATURE_LEARN;
  if (RDM_WITH_POLICY) f |= RDM_FEATURE_POLICY;
  return f;
}

rdm_result rdm_check_abi(uint32_t abi, uint32_t version) {
  return call([&] {
    if (abi != RDM_ABI) fail(Code::kVersion, "abi: the header has %u, but the library has %d", abi, RDM_ABI);
    if (version > RDM_VERSION)
      fail(Code::kVersion, "version: the header has %u, but the library has %d", version, RDM_VERSION);
  });
}

rdm_result rdm_check_experimental(uint32_t version) {
  return call([&] {
    if (version / 1000 != RDM_VERSION / 1000)
      fail(Code::kVersion,
           "version: the header has %u, but the library has %d, and experimental functions differ", version,
           RDM_VERSION);
  });
}

rdm_result rdm_build_info(rdm_build* io) {
  return call([&] {
    check_out(io, kFirstBuildSize, "io");
    rdm_build b{};
    b.abi = RDM_ABI;
    b.version = RDM_TEXT_OF_VALUE(RDM_VERSION_MAJOR) "." RDM_TEXT_OF_VALUE(
        RDM_VERSION_MINOR) "." RDM_TEXT_OF_VALUE(RDM_VERSION_PATCH);
    b.ode = RDM_ODE_VERSION;
    b.eigen = RDM_EIGEN_VERSION;
    b.ccd = RDM_CCD_VERSION;
    b.octomap = RDM_OCTOMAP_VERSION;
    b.precision = "double physics, float networks";
#if defined(__clang__)
    b.compiler = "clang " __clang_version__;
#else
    b.compiler = "gcc " __VERSION__;
#endif
#if RDM_WITH_POLICY
    b.kernels = kernel_isa();
#else
    b.kernels = "";
#endif
    b.differs = "";
#if RDM_WITH_SIM
    const KnownBytes& known = known_bytes();
    if (!known.ode || !known.ccd) b.differs = known.ccd ? "ODE" : known.ode ? "libccd" : "ODE, libccd";
#endif
    write_struct(io, b, kFirstBuildSize, "io");
  });
}

rdm_result rdm_init(const rdm_host* host) {
  return call([&] {
    const std::lock_guard lock(g_init_mutex);
    const HostHooks hooks = host ? hooks_from(host) : HostHooks{};
    if (g_init_count > 0 && host)
      fail(Code::kState, "rdm_init: it was called before, %s hooks; call rdm_shutdown first",
           g_init_hooks ? "with" : "without");
    if (g_init_count == 0) {
      set_host(hooks);
      g_init_hooks = host != nullptr;
    }
    ++g_init_count;
  });
}

void rdm_shutdown(void) {
  const std::lock_guard lock(g_init_mutex);
  if (g_init_count > 0 && --g_init_count == 0) set_host(HostHooks{});
}
