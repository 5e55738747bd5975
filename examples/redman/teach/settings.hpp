// What `train --from` is asked for, by flags and by what a demonstration says of itself.
#pragma once
#include <cstdint>
#include <string>

namespace tool {

// Everything that `train --from` was asked for; config.json keeps it.
struct TeachSettings {
  std::string from;            // demo, a .demo or .npz file, a policy file or a run folder; "": nothing
  int32_t decisions = 640;     // of each world, in a round
  double noise = 0.05;         // mean deviation of what is added to the teacher's actions
  bool success_only = false;   // rows of episodes without success are left out
  int32_t clone_epochs = 20;   // at most, in a round
  int32_t clone_patience = 0;  // epochs without a better validation loss that end it; 0: never
  double clone_rate = 1e-3;    // Adam's
  double validation = 0.1;     // share of rows held back
  int32_t pretrain = 0;  // clouds by which an encoder learns to tell points apart before; 0: it does not
  int32_t pretrain_epochs = 10;
  int32_t dagger = 0;          // further rounds, in which the student acts too
  double beta = 0.5;           // the teacher's share of decisions in round k: beta^k
  double start_share = 0;      // of episodes that begin at a state of the recording, in the first epoch
  double start_share_end = 0;  // in the last
  bool asked() const { return !from.empty(); }
};

// Numbers of those settings that a flag, or the line `teach NAME=VALUE` of a demonstration, gives.
struct TeachField {
  const char *name, *help;
  double least, most;
  int32_t TeachSettings::*whole;  // or
  double TeachSettings::*real;
};
inline constexpr TeachField kTeachFields[] = {
    {"demo-decisions", "number of the teacher's decisions in each world", 1, 1 << 24,
     &TeachSettings::decisions, nullptr},
    {"noise", "mean standard deviation of the noise on the teacher's actions", 0, 10, nullptr,
     &TeachSettings::noise},
    {"clone-epochs", "largest number of passes over the teacher's rows", 1, 100000,
     &TeachSettings::clone_epochs, nullptr},
    {"clone-patience",
     "passes without a better validation loss after which cloning ends; 0: it does not end early", 0, 100000,
     &TeachSettings::clone_patience, nullptr},
    {"clone-rate", "learning rate of cloning (Adam)", 0, 10, nullptr, &TeachSettings::clone_rate},
    {"validation", "share of the rows that are held back for validation", 0, 0.9, nullptr,
     &TeachSettings::validation},
    {"pretrain",
     "number of point clouds on which the encoder first learns to tell hands from objects; 0: none", 0,
     1 << 20, &TeachSettings::pretrain, nullptr},
    {"pretrain-epochs", "number of passes over the clouds of --pretrain", 1, 100000,
     &TeachSettings::pretrain_epochs, nullptr},
    {"dagger",
     "rounds of DAgger, in which the student acts and the teacher labels; --from may then be a policy", 0,
     1000, &TeachSettings::dagger, nullptr},
    {"beta", "in round k of DAgger the teacher takes a share beta^k of the decisions", 0, 1, nullptr,
     &TeachSettings::beta}};
inline const TeachField* find_teach_field(const std::string& name) {
  for (const TeachField& f : kTeachFields)
    if (name == f.name) return &f;
  return nullptr;
}

}  // namespace tool
