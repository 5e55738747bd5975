// What every algorithm understands, as values: a member for each shared row of option_tables.hpp, in its order.
#pragma once
#include "nn/mlp.hpp"

namespace rdm {

enum class RateKind : int32_t { kConstant, kLinear, kKl };
enum class ShieldLearn : int32_t { kOwn, kApplied, kCost, kEnd };  // what a refused decision teaches

// Texts are those of the Options that it was read from.
struct SharedOptions {
  const char* preset;
  // networks
  const char *hidden, *critic_hidden;
  Activation activation;
  double last_layer_scale;
  const char *actor_obs, *critic_obs;
  // seeing
  const char* encoder;
  Activation encoder_activation;
  bool encoder_frozen;
  int32_t encoder_points, encoder_classes;
  bool encoder_color;
  const char* encoder_origin;
  double encoder_range;
  // collecting
  int32_t horizon, action_repeat;
  double noise_correlation, init_std, std_min, std_max;
  bool learn_std;
  bool state_std;   // std_mode
  bool linear_std;  // std_schedule
  double average;
  ShieldLearn shield_learn;
  double shield_penalty;
  bool normalize_obs;
  double obs_clip, obs_count_max, obs_freeze;
  bool normalize_reward, normalize_cost;
  double reward_factor;
  // returns
  double discount, lambda, cost_lambda;
  bool standardize_reward_adv;
  bool standardize_cost_adv;  // scale_cost_adv
  bool discounted_limit, terminal_cost;
  // learning
  int32_t passes, minibatches, blocks;
  double learning_rate, critic_learning_rate;
  RateKind rate_kind;   // lr_schedule
  bool critics_follow;  // critic_lr_schedule
  int32_t total_epochs;
  double kl_target, kl_target_end, kl_factor, lr_min, lr_max, early_stop_kl, entropy, max_grad_norm;
  bool joint_grad_norm;
  double value_clip, critic_l2;
  // demonstrations
  int32_t warm_epochs;
  double imitation, imitation_decay;
  // costs
  double cost_limit, cost_limit_per_step;
  int32_t episode_steps;
  bool raw_costs;  // cost_signal
  // memory
  int32_t history;
  const char *history_fields, *memory;
  int32_t memory_chunk;
  // latent
  int32_t latent;
  const char *latent_fields, *latent_hidden;
  bool latent_student;  // latent_from
};

}  // namespace rdm
