// Learning from a teacher before learning from rewards: what `train --from` does.
//
// A teacher (a demonstration's script, or a policy) acts in worlds of its own. Its actions are carried out
// with noise, which takes the worlds off its path, while the labels stay clean: so the clone sees how to come
// back. The student's actor is fitted to the labels; with rounds of DAgger (Ross et al. 2011) the student
// then acts for a growing share of decisions, the teacher labels what it finds, and the student is fitted to
// all of it again.
#pragma once
#include <redman/record.hpp>
#include <redman/sense.hpp>

#include "play/actor.hpp"
#include "teach/settings.hpp"

namespace tool {

// A recording, and what it was.
struct Taught {
  redman::Recording recording;
  rdm_clone_report report = redman::sized<rdm_clone_report>();
  rdm_pretrain_report pretraining = redman::sized<rdm_pretrain_report>();
  bool cloned = false, pretrained = false;
};

// Options of the algorithm that keep what was taught: small deviations, critics first, an actor's rate that
// climbs from next to nothing. To be laid under the user's own.
Options taught_options(const TeachSettings& settings, const Options& given);

// What a demonstration says of how it is learned from (lines `teach` and `learn` of its script): its
// settings, but for those that `given` names, and options of the algorithm, to be laid under the user's own.
Options adopt_lesson(const std::vector<std::string>& given, const PoolSettings& pool,
                     TeachSettings& settings);

// Usage for a flag of `given` that does nothing beside what `from` is, or without another flag. After adopt_lesson.
void need_effect(const std::vector<std::string>& given, const PoolSettings& pool,
                 const TeachSettings& settings);

// First, if asked for, the agent's encoder learns to tell hands and things apart, in worlds where the teacher
// acts, or without one anything. Then fills the agent: by its teacher's labels, or where `from` is a policy
// and there are no rounds of DAgger, by that policy itself. `repeat`: control steps of a decision of the
// agent. `save`: a file for the recording,
// "": none. Progress goes to stderr.
Taught teach(const TeachSettings& settings, const PoolSettings& pool, redman::Agent& agent, int32_t repeat,
             const std::string& save);

// What the task's options must be for the teacher, under those of the run.
void adopt_teacher(const TeachSettings& settings, bool task_given, const std::vector<std::string>& sets,
                   PoolSettings& pool);

}  // namespace tool
