// What the tasks of Safety-Gym share: the lidar, the arena's things, their options.
#pragma once
#include <cstdint>

#include "base/option_rows.hpp"
#include "tasks/planar/flat_robot.hpp"
#include "tasks/planar/layout.hpp"
#include "tasks/planar/planar_learner.hpp"

namespace rdm {

// Bins of 22.5 degrees, counted from the x axis of the robot anticlockwise; 1 is touching, 0 out of range.
inline constexpr int kLidarBins = 16;
class Lidar {
 public:
  Lidar(const FlatRobot& robot, const elementary::SinCos& heading, double range, float* out);
  void add(const Spot& thing);

 private:
  const FlatRobot& robot_;
  const elementary::SinCos& heading_;
  double range_;
  float* bins_;
};
void write_lidar(const FlatRobot& robot, const elementary::SinCos& heading, double range, const Spot* things,
                 int32_t count, float* out);

inline constexpr double kRobotKeepout = 0.4, kHazardKeepout = 0.18;  // m
inline constexpr int32_t kMaxThings = 32;                            // of each kind
inline constexpr double kThingRadius = 0.11;  // m, disc for a vase or gremlin, a box of 0.2 m

inline constexpr CameraSpec kArenaCameras[] = {
    {"front", {0, -4.5, 4}, {0, 0, 0}, 0.8},
    {"top", {0, -0.01, 6}, {0, 0, 0}, 0.8},
};
inline constexpr auto kArenaLearner = join_defaults(kSafetyLearner, {{"horizon", "200"},
                                                                     {"learning_rate", "1e-3"},
                                                                     {"minibatches", "32"},
                                                                     {"action_repeat", "5"},
                                                                     {"discount", "0.97"},
                                                                     {"init_std", "0.6"},
                                                                     {"std_min", "0.05"},
                                                                     {"focops:multiplier_lr", "0.4"},
                                                                     {"pid_kp", "0.02"},
                                                                     {"pid_ki", "0.006"},
                                                                     {"pid_kd", "0.1"},
                                                                     {"pid_init", "0.3"},
                                                                     {"pid_smooth_p", "0.5"},
                                                                     {"cpo:violation_scale", "discount"},
                                                                     {"pcpo:violation_scale", "discount"},
                                                                     {"p3o:violation_scale", "discount"},
                                                                     {"p3o:minibatches", "2"},
                                                                     {"penalty", "8"},
                                                                     {"barrier_kappa", "0.5"},
                                                                     {"barrier_max", "6"}});
inline constexpr auto kPointLearner =
    join_defaults(kArenaLearner, {{"multiplier_init", "0.3"}, {"multiplier_lr", "0.2"}});
// The car must learn to turn before it can heed hazards: a multiplier that is there first keeps it still.
inline constexpr auto kCarArenaLearner =
    join_defaults(kArenaLearner, {{"multiplier_init", "0"}, {"multiplier_lr", "0.05"}});

// What every arena has by its options. Body 0 of its scene is the robot, body 1 marks the goal.
inline constexpr int32_t kRobotBody = 0, kGoalBody = 1, kFirstThing = 2;
struct ArenaOptions {
  double extent;  // m, half width of the layout
  int32_t hazards;
  double hazard_size, goal_reward, lidar_range;  // m, radius; 1; m
  int32_t max_steps;
};

// Option rows over O, an ArenaOptions and more: what every arena has, then those of the task.
struct ArenaLevel {
  double extent;  // m
  int32_t hazards;
};
template <class O, class... More>
consteval auto arena_rows(const ArenaLevel& level, const char* reward_help, const More&... more) {
  return option_rows<O>(
      row<&ArenaOptions::extent>(basic(number_option(
          "extent", level.extent, 0.5, 100, "half width of the square in which objects are placed, m"))),
      row<&ArenaOptions::hazards>(
          basic(integer_option("hazards", level.hazards, 0, kMaxThings, "number of hazards"))),
      row<&ArenaOptions::hazard_size>(number_option("hazard_size", 0.2, 0.01, 10, "radius of a hazard, m")),
      row<&ArenaOptions::goal_reward>(basic(number_option("goal_reward", 1, 0, 100, reward_help))),
      row<&ArenaOptions::lidar_range>(
          number_option("lidar_range", 3, 0.1, 100, "distance at and beyond which the lidar reads 0, m")),
      row<&ArenaOptions::max_steps>(
          basic(integer_option("max_steps", 1000, 1, 100000, "number of control steps in an episode"))),
      more...);
}

// The goal's mark; the hazards, at a place in the order of bodies that the task chooses.
void add_goal(double radius, PlanarScene& scene);
void add_hazards(const ArenaOptions& arena, PlanarScene& scene);
// In how many hazards [arena.hazards] the robot's middle is.
int32_t count_hazards(const ArenaOptions& arena, const FlatRobot& robot, const Spot* hazards);

// Things of the arena for pictures, bodies first, first + 1 ...: each lies at z, does not turn.
void place_things(World& world, int32_t first, const Spot* things, int32_t count, double z);

// A task of the arena with a robot R (flat_robot.hpp) and options O, an ArenaOptions and more.
template <class R, class O>
class ArenaTask : public PlanarTask {
 public:
  int32_t action_dim() const override { return R::kActions; }
  const char* action_order() const override { return R::kActionOrder; }

 protected:
  static constexpr double kControlDt = R::kSubsteps * R::kStep;  // s

  // `more` stands in the row after what the robot alone observes.
  ArenaTask(Scene&& scene, const O& options, std::initializer_list<FieldSpec> more)
      : PlanarTask(std::move(scene), options.max_steps, {{"accelerometer", "m/s2", 3}}), options_(options) {
    for (const RobotField& f : R::kFields) add({f.name, f.unit, f.count, f.low, f.high});
    for (const FieldSpec& f : more) add(f);
  }

  // At a drawn place, heading anywhere, at rest.
  static void start_robot(const Keepout& place, Stream& noise, World& world, R* robot) {
    *robot = {};
    robot->x = place.at.x, robot->y = place.at.y;
    robot->yaw = 2 * kPi * noise.uniform();
    show_robot(*robot, world);
  }
  static void show_robot(const R& r, World& world) {
    world.set_body(kRobotBody, planar_motion({r.x, r.y, R::kHeight}, r.yaw, r.vx, r.vy, r.w));
  }
  // The first part of the row; its end.
  static float* write_robot(const R& robot, const elementary::SinCos& heading, float* obs) {
    write_accelerometer(robot, heading, obs);
    R::write(robot, obs + 3);
    return obs + 3 + R::kRobotObs;
  }

  O options_;
};

}  // namespace rdm
