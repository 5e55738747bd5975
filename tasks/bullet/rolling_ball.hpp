// The ball of Bullet-Safety-Gym as a closed form: a sphere that rolls on a plane, pushed at its centre.
//
// 0.42 dv/dt = F - 0.012 v (1 + v) - 0.0024 w (1 + w) - 0.1413 with w = v / 0.5: mass and rolling inertia,
// Bullet's damping of linear and angular velocity, rolling friction, which stops the ball and never turns
// it round. Four substeps of 1/240 s follow Bullet 3.24 to four digits from rest at full force.
#pragma once
#include <cstdint>

#include "base/option.hpp"
#include "env/fields.hpp"
#include "physics/world.hpp"
#include "tasks/planar/planar_scene.hpp"

namespace rdm {

inline constexpr double kBallRadius = 0.5;  // m
inline constexpr double kBallControlDt = 1.0 / 60;

struct RollingBall {
  double x, y, vx, vy;  // m, m/s
};

void check_ball(const RollingBall& ball);  // of a saved state: Error(kFormat)

// One control step in `substeps` under the push 3.5 (action[0], action[1]) N, world axes; |entries| <= 1.
void roll(const float* action, RollingBall* ball, int32_t substeps = 4);
double ball_speed(const RollingBall& ball);

// 0.1 position (2), 0.2 velocity (2), 0.1 angular velocity (3).
inline constexpr int kBallObs = 7;
void write_ball(const RollingBall& ball, float* out);
Motion ball_motion(const RollingBall& ball);

// -0.5 |action|: part of the reward of every task with this ball.
double ball_effort(const float* action);

}  // namespace rdm
