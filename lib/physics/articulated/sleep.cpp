#include "physics/articulated/sleep.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <utility>

#include "base/simd.hpp"

namespace rdm {
namespace {

constexpr float kWarmReach = 0.02f;  // m between two substeps' points that count as one

bool is_push(const Wrench& push) {
  return dot(push.force, push.force) > 0 || dot(push.torque, push.torque) > 0;
}

}  // namespace

void set_body_bounds(const Scene& scene, const WorldState& s, Bound* bounds) {
  for (int32_t i = 0; i < scene.num_body_shapes; ++i) {
    const int32_t at = scene.first_body_shape + i;
    const SceneShape& shape = scene.shapes[static_cast<size_t>(at)];
    if (s.lists_fresh && s.asleep(shape.index)) {  // where it was
      bounds[at] = s.body_bounds[i];
      continue;
    }
    const Mat3& R_WB = s.free_bodies[shape.index].R;
    const Pose& X_BS = shape.def.X_LS;
    const SizedShape* own = s.sized ? s.sized + i : nullptr;
    const bool turned = X_BS.q.x != 0 || X_BS.q.y != 0 || X_BS.q.z != 0;
    set_bound(shape, s.bodies[shape.index].X.p + R_WB * (own ? own->p : X_BS.p),
              turned ? R_WB * to_matrix(X_BS.q) : R_WB, &bounds[at]);
    if (own) size_bound(shape, own->size_factor, &bounds[at]);
    if (s.sleep) s.body_bounds[i] = bounds[at];
  }
}

namespace {

// Where each point is on its shape a, for now and the next substep.
void place_points(const Contact* contacts, const int32_t* pairs, int32_t count, const Bound* bounds,
                  WarmPoint* out) {
  for (int32_t i = 0; i < count; ++i) {
    const float* center = bounds[contacts[i].shape_a].center;
    out[i].pair = pairs[i];
    for (int k = 0; k < 3; ++k)
      out[i].p[k] = static_cast<float>(contacts[i].p[k] - static_cast<double>(center[k]));
  }
}

// Its place from shape a's centre, and one number more.
Float4 place_of(const WarmPoint& point) {
  static_assert(sizeof(WarmPoint) >= offsetof(WarmPoint, p) + sizeof(Float4));
  Float4 p;
  std::memcpy(&p, reinterpret_cast<const char*>(&point) + offsetof(WarmPoint, p), sizeof p);
  return p;
}

// Each point starts from the impulse of the nearest of the last substep's points of the same pair, measured from
// shape a's centre (points slide with it), the first of those as near; NaN: there is none. Both lists are in the
// order of the pairs.
void match_points(WarmPoint* now, int32_t count, const WarmPoint* before, int32_t num_before) {
  for (int32_t i = 0, first = 0, last = 0; i < count;) {
    const int32_t pair = now[i].pair, begin = i;
    while (i < count && now[i].pair == pair) std::fill_n(now[i++].impulse, 3, NAN);
    for (first = last; first < num_before && before[first].pair < pair;) ++first;
    for (last = first; last < num_before && before[last].pair == pair;) ++last;
    float nearest[kMaxPairPoints];
    std::fill_n(nearest, kMaxPairPoints, kWarmReach * kWarmReach);
    for (int32_t k = first; k < last; k += kFloat4Lanes) {
      Float4 there[4];
      for (int l = 0; l < kFloat4Lanes; ++l) there[l] = place_of(before[std::min(k + l, last - 1)]);
      transpose(there);
      for (int32_t m = begin; m < i; ++m) {
        Float4 square{};
        for (int r = 0; r < 3; ++r) {
          const Float4 d = there[r] - splat(now[m].p[r]);
          square += d * d;
        }
        float& least = nearest[m - begin];
        for (uint32_t bits = bits_of(square < splat(least)); bits != 0; bits &= bits - 1) {
          const int l = std::countr_zero(bits);
          if (!(square[l] < least)) continue;
          least = square[l];
          std::copy_n(before[k + l].impulse, 3, now[m].impulse);
        }
      }
    }
  }
}

// Kept points are points like all others again.
void release_kept(WarmPoint* work, WorldState* s) {
  if (s->num_kept == 0) return;
  int32_t count = 0;
  each_warm(*s, [&](const WarmPoint& point) { work[count++] = point; });
  std::copy_n(work, count, s->warm);
  s->num_warm = count;
  s->num_kept = 0;
}

// Every body that sleeps with `body` under another name takes that of the lower one.
void unite(const Scene& scene, int32_t a, int32_t b, WorldState* s) {
  const auto [low, high] = std::minmax({s->sleep[a].island, s->sleep[b].island});
  for (int32_t i = 0; low != high && i < scene.num_bodies; ++i)
    if (s->sleep[i].island == high) s->sleep[i].island = low;
}

// Points among the sleeping. A pair keeps those of the last solve with their impulses, where they were on shape
// a; only normal and depth are of the nearest point found at rest, as points on a rim jump with any motion. A
// pair first found now keeps what is found, without a force. What is kept follows from poses and from
// impulses as a state stores them, and does not change when it is kept again. False: there is no room.
bool keep_points(const Scene& scene, const Bound* bounds, int32_t num_found, WorldState* s) {
  s->num_kept = 0;
  for (int32_t begin = 0, end = 0, at = 0; begin < num_found; begin = end) {
    const int32_t pair = s->contact_pairs[begin];
    while (end < num_found && s->contact_pairs[end] == pair) ++end;
    while (at < s->num_warm && s->warm[at].pair < pair) ++at;
    const int32_t first = at;
    while (at < s->num_warm && s->warm[at].pair == pair) ++at;
    const bool known = at > first;
    const int32_t count = known ? at - first : end - begin;
    if (s->num_kept + count > scene.def.solver.contacts_max) return false;
    const float* center = bounds[s->contacts[begin].shape_a].center;
    for (int32_t k = 0; k < count; ++k, ++s->num_kept) {
      WarmPoint& point = s->kept_warm[s->num_kept];
      s->kept_pairs[s->num_kept] = pair;
      if (known) {
        point = s->warm[first + k];
      } else {
        place_points(s->contacts + begin + k, s->contact_pairs + begin + k, 1, bounds, &point);
        std::fill_n(point.impulse, 3, 0.0f);
      }
      Vec3 p;
      for (int r = 0; r < 3; ++r) p[r] = static_cast<double>(center[r]) + static_cast<double>(point.p[r]);
      int32_t nearest = begin;
      double least = kStateBound * kStateBound;
      for (int32_t i = begin; i < end; ++i) {
        const Vec3 apart = s->contacts[i].p - p;
        if (!(dot(apart, apart) < least)) continue;
        least = dot(apart, apart);
        nearest = i;
      }
      s->kept[s->num_kept] = {p, s->contacts[nearest].n, s->contacts[nearest].depth};
    }
  }
  return true;
}

// The lists of pairs by who sleeps, and the points of pairs where both sides are at rest. False: there is no
// room for them all.
bool sort_pairs(const ArticulatedModel& model, Collider* collider, Collider::Poses& poses, WarmPoint* work,
                WorldState* s) {
  const Scene& scene = *model.scene;
  int32_t* const end = s->listed + model.listed_pairs.size();
  release_kept(work, s);
  s->lists_fresh = true;
  s->only_kept = false;
  s->num_searched = s->num_resting = 0;
  const auto rests = [&](int32_t side) {
    return side == ListedPair::kStatic || (side >= 0 && s->asleep(side));
  };
  for (const ListedPair& pair : model.listed_pairs) {
    if (s->num_asleep > 0 && rests(pair.a) && rests(pair.b))
      *(end - ++s->num_resting) = pair.pair;
    else
      s->listed[s->num_searched++] = pair.pair;
  }
  if (s->num_resting == 0) return true;
  int32_t* const resting = end - s->num_resting;
  std::reverse(resting, end);
  // `contacts` are free until the search
  const Collider::Found found = collider->collide_listed(scene, poses, {resting, s->num_resting}, s->contacts,
                                                         s->contact_pairs, s->touched);
  if (found.failed) s->diverged = true;
  // those of the others that stay
  const auto stays = [&](int32_t i, int32_t* at) {
    while (*at < s->num_resting && resting[*at] < s->warm[i].pair) ++*at;
    return *at == s->num_resting || resting[*at] != s->warm[i].pair;
  };
  int32_t left = 0;
  for (int32_t i = 0, at = 0; i < s->num_warm; ++i) left += stays(i, &at);
  if (found.overflow || !keep_points(scene, collider->bounds(), found.count, s) ||
      s->num_kept + left > scene.def.solver.contacts_max) {
    s->num_kept = 0;
    return false;
  }
  for (int32_t i = 0; i < s->num_kept; ++i) {
    const ShapePair& pair = scene.pairs[static_cast<size_t>(s->kept_pairs[i])];
    const int32_t a = scene.shapes[static_cast<size_t>(pair.a)].index,
                  b = scene.shapes[static_cast<size_t>(pair.b)].index;
    if (b >= 0) unite(scene, a, b, s);
  }
  left = 0;
  for (int32_t i = 0, at = 0; i < s->num_warm; ++i)
    if (stays(i, &at)) s->warm[left++] = s->warm[i];
  s->num_warm = left;
  return true;
}

// True if something moving touches something asleep, which it no longer is.
bool wake_touched(const Scene& scene, WorldState* s, int32_t count) {
  bool any = false;
  for (int32_t i = 0; i < count; ++i)
    for (const int32_t shape : {s->contacts[i].shape_a, s->contacts[i].shape_b}) {
      const SceneShape& of = scene.shapes[static_cast<size_t>(shape)];
      if (of.carrier != Carrier::kBody || !s->asleep(of.index)) continue;
      wake(scene, of.index, s);
      any = true;
    }
  return any;
}

}  // namespace

void find_contacts(const ArticulatedModel& model, Collider* collider, Collider::Poses& poses,
                   const uint64_t* near_robots, WarmPoint* work, WorldState* s) {
  const Scene& scene = *model.scene;
  Bound* bounds = collider->bounds();
  Collider::Found found{};
  for (;;) {
    if (s->sleep && !s->lists_fresh && !sort_pairs(model, collider, poses, work, s)) {
      wake_all(scene, s);
      continue;
    }
    const PairList listed = {s->listed, s->num_searched};
    const bool nothing = s->sleep && listed.count == 0 && model.all_listed;
    found = nothing ? Collider::Found{}
                    : collider->collide(scene, poses, s->sleep ? &listed : nullptr, near_robots, s->contacts,
                                        s->contact_pairs, s->touched);
    if (!s->sleep || s->num_asleep == 0) break;
    if (found.overflow || found.count + s->num_kept > scene.def.solver.contacts_max) {
      wake_all(scene, s);
      continue;
    }
    if (!wake_touched(scene, s, found.count)) break;
  }
  s->num_contacts = found.count;
  if (found.count > 0) s->only_kept = false;
  if (found.failed) s->diverged = true;
  if (found.overflow) s->status |= kStatusContactOverflow;
  place_points(s->contacts, s->contact_pairs, found.count, bounds, work);
  match_points(work, found.count, s->warm, s->num_warm);
  std::copy_n(work, found.count, s->warm);
  s->num_warm = found.count;
}

void fall_asleep(const ArticulatedModel& model, WorldState* s) {
  const Scene& scene = *model.scene;
  if (!s->sleep || s->num_asleep == scene.num_bodies) return;
  const SolverDef& solver = scene.def.solver;
  const Wrench* pushes = s->body_pushes(scene);
  bool any = false;
  for (int32_t i = 0; i < scene.num_bodies; ++i) {
    if (s->asleep(i)) continue;
    const Motion& m = s->bodies[i];
    const Vec3& g = s->body_models[i].gravity;
    const bool quiet = dot(m.v, m.v) < solver.sleep_speed * solver.sleep_speed &&
                       dot(m.w, m.w) < solver.sleep_spin * solver.sleep_spin && dot(g, g) > 0 &&
                       !(s->pushed && is_push(pushes[i]));
    int32_t& count = s->sleep[i].quiet;
    count = quiet ? std::min(count + 1, model.sleep_substeps) : 0;
    any |= count == model.sleep_substeps;
  }
  if (!any || s->diverged || (s->status & kStatusContactOverflow) != 0) return;
  // islands by their lowest body: a parent is never above its child
  constexpr uint8_t kRestless = 1, kSupported = 2;
  int32_t* parent = s->parent;
  for (int32_t i = 0; i < scene.num_bodies; ++i) {
    parent[i] = i;
    s->island_marks[i] = !s->asleep(i) && s->sleep[i].quiet < model.sleep_substeps ? kRestless : 0;
  }
  const auto root = [&](int32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  const auto side = [&](int32_t shape) -> const SceneShape& {
    return scene.shapes[static_cast<size_t>(shape)];
  };
  for (int32_t i = 0; i < s->num_contacts; ++i) {
    const SceneShape *a = &side(s->contacts[i].shape_a), *b = &side(s->contacts[i].shape_b);
    if (a->carrier != Carrier::kBody) std::swap(a, b);
    if (a->carrier != Carrier::kBody) continue;
    if (b->carrier == Carrier::kBody) {
      const int32_t x = root(a->index), y = root(b->index), low = std::min(x, y), high = std::max(x, y);
      parent[high] = low;
    } else {
      s->island_marks[a->index] |= b->carrier == Carrier::kStatic ? kSupported : kRestless;
    }
  }
  for (int32_t i = 0; i < scene.num_bodies; ++i) s->island_marks[root(i)] |= s->island_marks[i];
  for (int32_t i = 0; i < scene.num_bodies; ++i) {
    const int32_t island = root(i);
    if (s->asleep(i) || s->island_marks[island] != kSupported) continue;
    s->sleep[i].island = island;
    Motion& m = s->bodies[i];
    m.v = m.w = {};
    FreeBody& body = s->free_bodies[i];
    body.v = body.w = body.v1 = body.w1 = {};
    ++s->num_asleep;
    s->lists_fresh = false;
  }
}

void begin_sleepers(const ArticulatedModel& model, WorldState* s) {
  if (!s->sleep || s->num_asleep == 0) return;
  const Wrench* pushes = s->body_pushes(*model.scene);
  for (int32_t i = 0; s->pushed && i < model.scene->num_bodies; ++i)
    if (is_push(pushes[i])) wake(*model.scene, i, s);
  for (int32_t i = 0; s->lists_fresh && i < s->num_kept; ++i) s->touched[s->kept_pairs[i]] = 1;
}

int32_t report_contacts(const Scene& scene, WorldState* s) {
  if (s->num_kept == 0) return s->num_contacts;
  const int32_t total = s->num_contacts + s->num_kept;
  if (s->only_kept) return total;
  const double inv_h = 1 / scene.def.solver.h;
  const auto kept_contact = [&](int32_t i) {
    const ShapePair& pair = scene.pairs[static_cast<size_t>(s->kept_pairs[i])];
    const KeptPoint& point = s->kept[i];
    Vec3 force;
    for (int r = 0; r < 3; ++r) force[r] = inv_h * static_cast<double>(s->kept_warm[i].impulse[r]);
    return Contact{pair.a, pair.b, point.p, point.n, point.depth, force, {}};
  };
  int32_t moving = s->num_contacts - 1, kept = s->num_kept - 1;
  for (int32_t to = total - 1; kept >= 0; --to) {
    const bool later = moving >= 0 && s->contact_pairs[moving] > s->kept_pairs[kept];
    s->contacts[to] = later ? s->contacts[moving] : kept_contact(kept);
    s->contact_pairs[to] = later ? s->contact_pairs[moving] : s->kept_pairs[kept];
    --(later ? moving : kept);
  }
  s->only_kept = s->num_contacts == 0;
  return total;
}

void wake(const Scene& scene, int32_t body, WorldState* s) {
  if (!s->sleep) return;
  const int32_t island = s->sleep[body].island;
  s->sleep[body].quiet = 0;
  if (island == kAwake) return;
  for (int32_t i = 0; i < scene.num_bodies; ++i) {
    if (s->sleep[i].island != island) continue;
    s->sleep[i] = {kAwake, 0};
    --s->num_asleep;
  }
  s->lists_fresh = false;
}

void wake_all(const Scene& scene, WorldState* s) {
  if (!s->sleep) return;
  for (int32_t i = 0; i < scene.num_bodies; ++i) s->sleep[i] = {kAwake, 0};
  s->num_asleep = 0;
  s->lists_fresh = false;
}

void forget_kept(const Scene& scene, WorldState* s) {
  if (!s->sleep) return;
  s->num_kept = s->num_asleep = 0;
  s->lists_fresh = s->only_kept = false;
  for (int32_t i = 0; i < scene.num_bodies; ++i) {
    if (!s->asleep(i)) continue;
    ++s->num_asleep;
    FreeBody& body = s->free_bodies[i];
    body.v = body.w = body.v1 = body.w1 = {};
  }
}

}  // namespace rdm
