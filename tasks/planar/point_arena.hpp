// What the Point tasks of Safety-Gym share: the lidar, the arena's things.
#pragma once
#include <cstdint>

#include "base/option.hpp"
#include "tasks/planar/layout.hpp"
#include "tasks/planar/planar_learner.hpp"
#include "tasks/planar/point_robot.hpp"

namespace rdm {

// Bins of 22.5 degrees, counted from straight ahead to the left; 1 is touching, 0 out of range.
inline constexpr int kLidarBins = 16;
class Lidar {
 public:
  Lidar(const PointRobot& robot, const elementary::SinCos& heading, double range, float* out);
  void add(const Spot& thing);

 private:
  const PointRobot& robot_;
  const elementary::SinCos& heading_;
  double range_;
  float* bins_;
};
void write_lidar(const PointRobot& robot, const elementary::SinCos& heading, double range, const Spot* things,
                 int32_t count, float* out);

inline constexpr double kPointLidarRange = 3;                        // m
inline constexpr double kRobotKeepout = 0.4, kHazardKeepout = 0.18;  // m
inline constexpr int32_t kMaxThings = 32;                            // of each kind
inline constexpr double kThingRadius = 0.11;  // m, disc for a vase or gremlin, a box of 0.2 m

inline constexpr CameraSpec kPointCameras[] = {
    {"front", {0, -4.5, 4}, {0, 0, 0}, 0.8},
    {"top", {0, -0.01, 6}, {0, 0, 0}, 0.8},
};
inline constexpr auto kPointLearner = join_defaults(kSafetyLearner, {{"horizon", "200"},
                                                                     {"learning_rate", "1e-3"},
                                                                     {"minibatches", "32"},
                                                                     {"action_repeat", "5"},
                                                                     {"discount", "0.97"},
                                                                     {"init_std", "0.6"},
                                                                     {"std_min", "0.05"},
                                                                     {"multiplier_init", "0.3"},
                                                                     {"multiplier_lr", "0.2"},
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

// What every arena has by its options. Body 0 of its scene is the robot, body 1 marks the goal.
inline constexpr int32_t kRobotBody = 0, kGoalBody = 1, kFirstThing = 2;
struct PointArena {
  double extent, hazard_size, range;  // m: half width of the layout, radius of a hazard, range of the lidars
  int32_t hazards;
};
PointArena point_arena_from(const Options& options);
// The first two bodies; the hazards, at a place in the order of bodies that the task chooses.
void add_robot_and_goal(double goal_mark, PlanarScene& scene);
void add_hazards(const Options& options, PlanarScene& scene);
// The robot at a drawn place, heading anywhere.
void start_robot(const Keepout& place, Stream& noise, World& world, PointRobot* robot);
// In how many hazards [arena.hazards] the robot's middle is.
int32_t count_hazards(const PointArena& arena, const PointRobot& robot, const Spot* hazards);

// Things of the arena for pictures, bodies first, first + 1 ...: each lies at z, does not turn.
void place_things(World& world, int32_t first, const Spot* things, int32_t count, double z);

}  // namespace rdm
