// How the robots and trees of a .task file are played: where their joints begin, which of them the action moves and how, and the
// factors that a reset draws.
#pragma once
#include "text_scene.hpp"

namespace rdm::import {

class PlayerText : public SceneText {
 public:
  using SceneText::SceneText;
  void read_players();

 protected:
  int32_t row_of(const Part& part, const Table& t, int line, const std::string& name) const;
  // A list of all joints' numbers, or { joint = number } over what stands there.
  void read_joints(const Part& part, const char* key, Span* out) const;
  void add_player(size_t index);
  size_t num_robots() const { return top_.rows("robot").size(); }
  void add_actions(const Table& t, int32_t count, float hold);
  void controls(const Part& part, bool robot, Player* player);
  void add_factor(const Table& t);

  std::vector<float> hold_;  // the action that holds them
  int32_t num_joints_ = 0;
};

}  // namespace rdm::import
