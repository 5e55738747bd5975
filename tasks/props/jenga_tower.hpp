// The tower of the Jenga task: where its blocks, the target among them, and the table stand.
#pragma once
#include "base/option.hpp"
#include "env/option_table.hpp"
#include "physics/model/scene.hpp"

namespace rdm {

inline constexpr int32_t kJengaBlocks = 16;  // without the target

// Sizes and places of one tower. Body 0 is the target, bodies 1 to 16 are the blocks, from the table up.
struct JengaTower {
  int32_t blocks = kJengaBlocks;                   // that there are; 0: the target lies on the table
  Vec3 table, table_half;                          // centre and half sizes, m
  Vec3 half[1 + kJengaBlocks];                     // m; no block is turned
  Vec3 place[1 + kJengaBlocks];                    // at rest, m
  double mass[1 + kJengaBlocks] = {};              // kg
  double friction = 0;                             // of two blocks
  double moved = 0;                                // m, from which a block counts as moved
  double target_end() const { return half[0].y; }  // m, from the target's centre to its face at -y
};

void add_tower_options(OptionTable& table);
// Blocks sink by the depth at which things rest, m.
JengaTower jenga_tower_from(const Options& options, double contact_layer);

// Bodies and table; the target has material `target`, the blocks `block`.
void add_tower(const JengaTower& tower, int32_t target, int32_t block, int32_t table, SceneDef* scene);

}  // namespace rdm
