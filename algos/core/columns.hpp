// Which entries of an observation a network sees: options actor_obs and critic_obs.
//
// A list of words separated by commas, read from the left: a field's name or a pattern with '*' adds entries,
// with '!' before it takes them away; a list that begins so has all at first. Four words are lists by
// themselves where no field has their name: state is all, proprioception what the robot's own joints, bases
// and last action tell (of small worlds the inertial sensors), touch that and the fingertips' forces, vision
// touch and where the goal is: all that stands beside a cloud, and nothing of where an object is or how it
// moves or differs from its goal.
#pragma once
#include <cstdint>

#include "base/arena.hpp"
#include "nn/obs_field.hpp"

namespace rdm {

// The columns, ascending; empty when they are all of [0, obs_dim). Error(kNotFound) for a word that names
// nothing, kArgument when nothing is left, or for names without fields.
Vector<int32_t> select_columns(const char* key, const char* list, const ObsField* fields, int32_t num_fields,
                               int32_t obs_dim);

// A copy in the arena; of texts what may be printed (base/text.hpp). Null while it measures.
const ObsField* keep_fields(Arena& arena, const ObsField* fields, int32_t num_fields);

}  // namespace rdm
