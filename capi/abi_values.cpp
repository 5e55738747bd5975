// Numbers that cross the ABI by a cast have the same value on both sides; nothing here is code.
#include "capi/handles.hpp"

namespace rdm::capi {
namespace {

// Values of an enumeration, or limits, of the library and of redman.h.
template <class Ours, class Theirs>
constexpr bool same(Ours ours, Theirs theirs) {
  return static_cast<int64_t>(ours) == static_cast<int64_t>(theirs);
}

static_assert(same(Code::kOk, RDM_OK) && same(Code::kArgument, RDM_ERROR_ARGUMENT));
static_assert(same(Code::kRange, RDM_ERROR_RANGE) && same(Code::kState, RDM_ERROR_STATE));
static_assert(same(Code::kMemory, RDM_ERROR_MEMORY) && same(Code::kIo, RDM_ERROR_IO));
static_assert(same(Code::kFormat, RDM_ERROR_FORMAT) && same(Code::kVersion, RDM_ERROR_VERSION_MISMATCH));
static_assert(same(Code::kUnsupported, RDM_ERROR_UNSUPPORTED) && same(Code::kPhysics, RDM_ERROR_PHYSICS));
static_assert(same(Code::kNotFound, RDM_ERROR_NOT_FOUND) && same(Code::kCancelled, RDM_ERROR_CANCELLED));
static_assert(same(Code::kInternal, RDM_ERROR_INTERNAL));

static_assert(same(OptionKind::kNumber, RDM_KIND_NUMBER) && same(OptionKind::kInteger, RDM_KIND_INTEGER));
static_assert(same(OptionKind::kFlag, RDM_KIND_FLAG) && same(OptionKind::kText, RDM_KIND_TEXT));
static_assert(same(kOptionTextSize, RDM_TEXT_SIZE));

#if RDM_WITH_SIM
static_assert(same(kMaxTaskCosts, RDM_MAX_COSTS));
static_assert(same(Autoreset::kSameStep, RDM_AUTORESET_SAME_STEP));
static_assert(same(Autoreset::kNextStep, RDM_AUTORESET_NEXT_STEP));
static_assert(same(Autoreset::kOff, RDM_AUTORESET_OFF));
static_assert(same(kStatusContactOverflow, RDM_STATUS_CONTACTS));
static_assert(same(kStatusDiverged, RDM_STATUS_DIVERGED));
static_assert(same(kStatusBadAction, RDM_STATUS_BAD_ACTION));
static_assert(same(kStatusUnconverged, RDM_STATUS_SOLVER));
static_assert(same(kStatusSlowed, RDM_STATUS_SLOWED));
static_assert(same(Baseline::kZero, RDM_BASELINE_ZERO) && same(Baseline::kHold, RDM_BASELINE_HOLD));
static_assert(same(Baseline::kRandom, RDM_BASELINE_RANDOM));
static_assert(same(ShapeKind::kSphere, RDM_SHAPE_SPHERE) && same(ShapeKind::kCapsule, RDM_SHAPE_CAPSULE));
static_assert(same(ShapeKind::kBox, RDM_SHAPE_BOX) && same(ShapeKind::kCylinder, RDM_SHAPE_CYLINDER));
static_assert(same(ShapeKind::kPlane, RDM_SHAPE_PLANE) && same(ShapeKind::kEllipsoid, RDM_SHAPE_ELLIPSOID));
static_assert(same(ShapeKind::kHull, RDM_SHAPE_HULL));
#endif

#if RDM_WITH_LEARN
static_assert(same(kMaxCosts, RDM_MAX_COSTS));
#endif

}  // namespace
}  // namespace rdm::capi
