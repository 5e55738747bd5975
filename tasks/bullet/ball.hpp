// The ball of Bullet-Safety-Gym as an agent: pushed at its centre, world axes; rolling_ball.hpp has its law.
#pragma once
#include "tasks/bullet/agent.hpp"
#include "tasks/bullet/rolling_ball.hpp"
#include "tasks/state_check.hpp"

namespace rdm {

struct Ball {
  struct State {
    RollingBall ball;
    double effort;
  };
  static constexpr EngineKind kEngine = EngineKind::kKinematic;
  static constexpr int32_t kActions = 2, kSteps = 250, kBodies = 1;
  static constexpr const char* kActionOrder = "push x, push y";
  static constexpr AgentField kFields[] = {
      {"position", "10 m", 2}, {"velocity", "5 m/s", 2}, {"spin", "10 rad/s", 3}};
  static constexpr double kSpeedLimit = 2.5, kSize = kBallRadius;
  static constexpr double kBounce = 0.35;  // restitution of ball and wall, multiplied
  static constexpr bool kPillars = false;

  static void add(PlanarScene& scene, const AgentDrive&) {
    scene.body("ball", ShapeKind::kSphere, {kBallRadius, 0, 0}, kMarkBlue);
  }
  static void check(const State& s) {
    check_ball(s.ball);
    check_numbers("effort", &s.effort, 1);
  }
  static void start(const AgentStart& at, Stream&, World&, State* s) { s->ball = {at.x, at.y, 0, 0}; }
  static void act(const float* action, const AgentDrive& drive, World&, State* s) {
    roll(action, &s->ball, drive.substeps);
    s->effort = ball_effort(action);
  }
  static void show(World& world, const State& s) { world.set_body(0, ball_motion(s.ball)); }
  static void settle(const World&, State*) {}
  static AgentPlace look(const World&, const State& s) {
    return {s.ball.x, s.ball.y, kBallRadius, s.ball.vx, s.ball.vy, ball_speed(s.ball)};
  }
  // It has no front: what it senses is in world axes.
  static elementary::SinCos heading(const World&, const State&) { return {0, 1}; }
  static double effort(const World&, const State& s) { return s.effort; }
  static bool alive(const World&, const State&) { return true; }
  static void block(double nx, double ny, double depth, double away, State* s) {
    RollingBall& b = s->ball;
    const double into = std::max(0.0, nx * b.vx + ny * b.vy - away) * (1 + kBounce);
    b.x -= depth * nx;
    b.y -= depth * ny;
    b.vx -= into * nx;
    b.vy -= into * ny;
  }
  static void write(const World&, const State& s, float* out) { write_ball(s.ball, out); }
};

}  // namespace rdm
