// Islands of free bodies that sleep: a pile at rest costs next to nothing.
//
// An island is a connected component of free bodies over contact points; static shapes do not connect. A body
// is quiet in a substep that leaves |v| < sleep_speed and |w| < sleep_spin, unless it is pushed or feels no
// gravity. An island falls asleep at the end of a substep
//   - in which all its bodies have been quiet for sleep_time without a break,
//   - some body of it touches a static shape, and none touches a shape of an articulation,
//   - and no contact point was left out.
// Its bodies then stand still, v = w = 0. The points of the last solve are kept: they are reported with its
// forces, they count and touch, and their impulses start the next solve; normals and depths are found once
// more, where the bodies have come to rest. The pairs among them and with static shapes are not searched.
// It wakes as a whole, in the substep (contacts are searched anew) or call in which
//   - an awake body or a shape of an articulation is found to touch one of its bodies,
//   - one of its bodies is set or pushed, or dynamics are set,
//   - a world's points would be more than contacts_max, or its numbers diverge.
// Two islands found to touch where they stand become one. All of it is exact: a state says of each body which
// island it sleeps in and how long it has been quiet; kept points follow from poses and stored impulses.
#pragma once
#include "physics/articulated/world_state.hpp"

namespace rdm {

// Of the shapes on free bodies, among the bounds of all; the capsule axis too, for all that have one.
void set_body_bounds(const Scene& scene, const WorldState& s, Bound* bounds);
// Contact points of the present poses: those that move into contacts, those asleep into kept. Whom a moving
// one touches is awake afterwards. The collider's bounds of bodies' shapes are set by the caller, and those of
// all shapes of trees unless `near_robots` is given (BroadPhase::search). `work` has room for contacts_max.
void find_contacts(const ArticulatedModel& model, Collider* collider, Collider::Poses& poses,
                   const uint64_t* near_robots, WarmPoint* work, WorldState* s);
// At the end of a substep.
void fall_asleep(const ArticulatedModel& model, WorldState* s);
// Of a step: pushed bodies are awake, pairs asleep touch.
void begin_sleepers(const ArticulatedModel& model, WorldState* s);
// Kept points in their places among contacts; their number.
int32_t report_contacts(const Scene& scene, WorldState* s);

// A body and all that sleep with it; an awake one starts to count anew.
void wake(const Scene& scene, int32_t body, WorldState* s);
void wake_all(const Scene& scene, WorldState* s);
// Sleep was loaded: nothing else is known of it.
void forget_kept(const Scene& scene, WorldState* s);
// visit(point) for all points from which the next solve starts, num_warm and num_kept, in the order of their pairs.
template <class Visit>
void each_warm(const WorldState& s, const Visit& visit) {
  for (int32_t i = 0, k = 0; i < s.num_warm || k < s.num_kept;) {
    const bool moving = k == s.num_kept || (i < s.num_warm && s.warm[i].pair < s.kept_warm[k].pair);
    visit(moving ? s.warm[i++] : s.kept_warm[k++]);
  }
}

}  // namespace rdm
