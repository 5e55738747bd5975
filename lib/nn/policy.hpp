// The frozen policy: normaliser, actor network, action scale; runs on a machine that has nothing else.
// Serialised form: the policy.rdm file (base/bytes.hpp), magic "RDMPOLIC". Version 2 is written for a policy
// whose deviation depends on the state, version 3 for one that sees a part of the observation alone, version
// 4 for one that sees points, version 5 for one that sees their colours, version 6 for one in groups, version 7 for one
// that has a memory, version 8 for one whose actions are squashed, version 9 for one in groups that have memories,
// version 10 for one with a latent, version 11 for one that sees points and has a history or a latent: versions before
// do not know these.
// Sections FLDS, the names of fields, GENR, the generation, and SEEN, what is usual in a row, came later and
// are in files of each version: a reader finds sections by their tags, and passes over others.
#pragma once
#include <cstdint>

#include "base/bytes.hpp"
#include "base/file.hpp"
#include "nn/actor_group.hpp"
#include "nn/gru.hpp"
#include "nn/latent.hpp"
#include "nn/novelty.hpp"
#include "nn/obs_field.hpp"
#include "nn/pointnet.hpp"
#include "nn/squash.hpp"

namespace rdm {

inline constexpr char kPolicyMagic[8] = {'R', 'D', 'M', 'P', 'O', 'L', 'I', 'C'};
inline constexpr uint32_t kPolicyVersion = 11;
inline constexpr int32_t kMaxHistory = 1024;

// A library of policies alone has no calls that take states or points (capi/stubs.awk): it refuses such policies, and the
// networks that only they have are not linked.
#ifdef RDM_POLICIES_ALONE
inline constexpr bool kStatesAndPoints = false;
#else
inline constexpr bool kStatesAndPoints = true;
#endif

// Everything that a policy file holds, as views of memory that somebody else owns.
struct PolicyView {
  MlpShape
      actor;  // in: entries that it sees; out: action_dim, or with state_std twice that, log deviations last
  // Networks of their own, each of its entries of the action: `actor` is the shape of all together, which sees each
  // entry of the row, and params are theirs, one behind the other. None: it is one network.
  const ActorGroup* group = nullptr;  // [num_groups]
  int32_t num_groups = 0;             // 0, or 2 to kMaxGroups
  // What it remembers, of a row of a batch, is its state, state_dim() numbers, zeros at first: the state of the GRU
  // before its last layer, or the history entries of its last `history` - 1 decisions as the network saw them,
  // newest first, which stand behind the entries of the row. Of groups the states of their GRUs.
  GruShape gru;                              // units 0: none; of each group so many
  int32_t history = 1;                       // decisions that it sees, this one included
  const int32_t* history_entries = nullptr;  // [history_width] of entries(), ascending; null: all
  int32_t history_width = 0;
  PointNetShape eyes;                  // points 0: none; their features are the actor's last inputs
  const float* eyes_params = nullptr;  // [eyes.num_params()]
  // mu and pi, of which `actor` is pi's: z stands behind its own inputs. Their columns are of the entries with the
  // history.
  LatentShape latent;                    // none without numbers
  const float* latent_params = nullptr;  // [latent.num_params()]
  const int32_t* columns = nullptr;      // [entries()] entries of the row, ascending; null: all of them
  int32_t row_dim = 0;                   // entries of a row; of no use without columns
  const float* params = nullptr;         // [num_params()]
  const float* log_std = nullptr;        // [action_dim], null with state_std
  bool state_std = false;                // the network gives the log deviations
  float std_bounds[2] = {};              // lowest and highest of these
  Squash squash = Squash::kNone;         // what makes actions of the outputs
  const float* shift = nullptr;        // [entries()] observation normaliser: clip((x - shift) scale, +-clip)
  const float* scale = nullptr;        // [entries()]
  float clip = 0;                      // 0: no normaliser
  Novelty usual;                       // of rows in training; unknown without a normaliser
  int32_t action_repeat = 1;           // control steps per decision
  float noise_correlation = 0;         // AR(1) coefficient of the exploration noise
  float control_dt = 0;                // s, 0 unknown
  uint64_t layout_hash = 0;            // of the observation and action layout, 0 unknown
  uint64_t generation = 0;             // which network, 0 unknown: of whoever wrote it
  char task[64] = "";                  // "" for a host's own environment
  const ObsField* fields = nullptr;    // [num_fields] parts of a row
  int32_t num_fields = 0;              // 0: their names are unknown
  const float* example_obs = nullptr;  // [obs_dim()], null: zeros are written
  const float* example_action = nullptr;  // [action_dim], the mean action for it; a load checks it
  const int16_t* example_points =
      nullptr;  // [eyes.points][3], with what else it sees; null: some that are made up
  const uint8_t* example_classes = nullptr;  // [eyes.points]
  const uint8_t* example_colors = nullptr;   // [eyes.points][3]

  RecurrentShape net() const { return {actor, gru}; }
  size_t num_params() const { return num_groups ? group_params(group, num_groups) : net().num_params(); }
  int32_t history_inputs() const { return (history - 1) * history_width; }
  int32_t state_dim() const {
    return kStatesAndPoints ? gru.units * std::max(num_groups, 1) + history_inputs() : 0;
  }
  bool has_gru() const { return kStatesAndPoints && gru.units; }
  bool has_eyes() const { return kStatesAndPoints && eyes.points; }
  // of a row, that it sees
  int32_t entries() const { return latent ? latent.entries : actor.in - eyes.features() - history_inputs(); }
  int32_t obs_dim() const { return columns ? row_dim : entries(); }
  int32_t action_dim() const { return state_std ? actor.out / 2 : actor.out; }
};
void write_policy(Writer& out, const PolicyView& view);
// Writes group i of a policy alone, as a policy of its own: of the entries that it sees, with its actions. How usual a
// row is is not known of it.
void write_group(Writer& out, const PolicyView& view, int32_t i);

// A decision more in a history: seen [entries] of which the listed ones (null: the first `width`) become the newest of
// state [depth][width].
void push_history(float* state, int32_t depth, int32_t width, const float* seen, const int32_t* listed);

// An owned, immutable policy. act is const and uses only the caller's scratch.
class Policy {
 public:
  // Copies. Error(kFormat) for anything that is not a whole policy file, kVersion for a newer one.
  // The hooks are all that it takes memory from.
  static Policy* read(const void* bytes, size_t size, const HostHooks& hooks);
  // Bytes that read takes, in two blocks: the object's, as a multiple of Arena::kAlign, then the arena's. It
  // finds all that can be wrong but an example that the network does not give.
  static size_t memory(const void* bytes, size_t size);
  static void destroy(Policy* p);
  static FileLimits file_limits();  // of policy files

  const PolicyView& view() const { return view_; }
  size_t scratch_bytes(int32_t rows) const;
  // action [rows][action_dim] = clip(mean + std * noise, -1, 1); noise, as action, standard normals or null
  // for the mean. scratch: scratch_bytes(rows) bytes, 64-byte aligned.
  // clouds [rows]: of a policy that sees points. state [rows][state_dim()] is what it remembers of the decisions
  // before, and becomes what it remembers of this one too.
  void act(const float* obs, int32_t rows, const float* noise, float* action, void* scratch,
           const PointRows& clouds = {}, float* state = nullptr) const;
  // The same without the clip, of one that sees no points; the mean too. One of the two may be null.
  void sample(const float* obs, int32_t rows, const float* noise, float* action, float* mean, void* scratch,
              float* state = nullptr) const;

  // novelty [rows] of obs; view().usual must be known.
  void novelty(const float* obs, int32_t rows, float* novelty) const;

  // Becomes what a file of `from` would be read as, but for the names of fields; sizes and action_repeat agree.
  // Error(kArgument) for numbers that a file is refused for: nothing changes.
  void update(const PolicyView& from);

 private:
  HostHooks hooks_;
  Arena arena_;
  PolicyView view_;
  unsigned char* scratch_ = nullptr;  // for one row: of the example
  float* state_ = nullptr;            // [state_dim()] likewise
};

}  // namespace rdm
