// What the tables of tasks, algorithms, robots and objects promise to whoever builds a menu from them.
#include <gtest/gtest.h>
#include <redman/redman.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <iterator>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {

void check_option(const rdm_option_spec& o, const char* owner) {
  SCOPED_TRACE(std::string(owner) + "." + o.key);
  ASSERT_GT(std::strlen(o.key), 0u);
  ASSERT_NE(o.help, nullptr);
  EXPECT_GT(std::strlen(o.help), 0u);
  EXPECT_TRUE(o.live == 0 || o.live == 1);
  if (o.kind == RDM_KIND_TEXT) {
    ASSERT_NE(o.text, nullptr);
    EXPECT_LT(std::strlen(o.text), static_cast<size_t>(RDM_TEXT_SIZE));
    const std::string choices = o.choices ? std::string("|") + o.choices + "|" : "";
    EXPECT_TRUE(!o.choices || choices.find(std::string("|") + o.text + "|") != std::string::npos) << choices;
    return;
  }
  EXPECT_STREQ(o.choices ? o.choices : "a..b", "a..b");
  EXPECT_TRUE(!o.text || (o.choices && std::strstr(o.text, ".."))) << o.text;
  EXPECT_LE(o.low, o.number);
  EXPECT_LE(o.number, o.high);
  EXPECT_TRUE(o.kind != RDM_KIND_FLAG || (o.low == 0 && o.high == 1));
  EXPECT_TRUE(o.kind == RDM_KIND_NUMBER || o.number == std::floor(o.number));
}

std::vector<rdm_task> all_tasks() {
  std::vector<rdm_task> tasks;
  for (int32_t i = 0; i < rdm_task_count(); ++i) {
    rdm_task t;
    t.struct_size = sizeof t;
    EXPECT_EQ(rdm_task_at(i, &t), RDM_OK) << rdm_last_error();
    tasks.push_back(t);
  }
  return tasks;
}

// A menu asks for every field of every task: no task is made for each of them.
TEST(Discovery, FieldsAreAtHand) {
  const auto tasks = all_tasks();
  int64_t fields = 0;
  const auto begin = std::chrono::steady_clock::now();
  for (size_t t = 0; t < tasks.size(); ++t) {
    int32_t offset = 0;
    for (int32_t i = 0; i < tasks[t].num_fields; ++i, ++fields) {
      rdm_field_info f = RDM_INIT(rdm_field_info), again = f;
      ASSERT_EQ(rdm_task_field_at(static_cast<int32_t>(t), i, &f), RDM_OK) << rdm_last_error();
      ASSERT_EQ(rdm_task_field_at(static_cast<int32_t>(t), i, &again), RDM_OK);
      EXPECT_EQ(f.name, again.name);  // the same text, which stays
      EXPECT_EQ(f.offset, offset);
      EXPECT_GT(std::strlen(f.name), 0u);
      EXPECT_GT(std::strlen(f.unit), 0u);
      offset += f.count;
    }
    EXPECT_EQ(offset, tasks[t].obs_dim) << tasks[t].name;
    rdm_field_info past = RDM_INIT(rdm_field_info);
    EXPECT_EQ(rdm_task_field_at(static_cast<int32_t>(t), tasks[t].num_fields, &past), RDM_ERROR_RANGE);
  }
  const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - begin;
  // far below the 10 ms that making one task can take, and far above what a table needs
  EXPECT_LT(took.count() / static_cast<double>(fields), 100) << fields << " fields";
}

TEST(Discovery, TasksAreFoundByTheirNames) {
  const auto tasks = all_tasks();
  ASSERT_GE(tasks.size(), 2u);
  std::set<std::string> names;
  for (size_t i = 0; i < tasks.size(); ++i) {
    EXPECT_TRUE(names.insert(tasks[i].name).second) << tasks[i].name;
    EXPECT_GT(std::strlen(tasks[i].summary), 0u);
    int32_t found = -1;
    EXPECT_EQ(rdm_task_find(tasks[i].name, &found), RDM_OK);
    EXPECT_EQ(found, static_cast<int32_t>(i));
  }
  int32_t found = -1;
  EXPECT_EQ(rdm_task_find("Hand-Over-SAFE-finger", &found), RDM_OK);
  EXPECT_STREQ(tasks[static_cast<size_t>(found)].name, "hand_over_safe_finger");
  EXPECT_EQ(rdm_task_find("hand_over_safe_finder", &found), RDM_ERROR_NOT_FOUND);
  EXPECT_NE(std::string(rdm_last_error()).find("hand_over_safe_finger"), std::string::npos)
      << rdm_last_error();
}

TEST(Discovery, FieldsCoverTheObservationWithoutGaps) {
  const auto tasks = all_tasks();
  for (int32_t t = 0; t < rdm_task_count(); ++t) {
    const rdm_task& task = tasks[static_cast<size_t>(t)];
    SCOPED_TRACE(task.name);
    int32_t next = 0;
    std::set<std::string> names;
    rdm_field_info f = RDM_INIT(rdm_field_info);
    for (int32_t i = 0; i < task.num_fields; ++i) {
      ASSERT_EQ(rdm_task_field_at(t, i, &f), RDM_OK) << rdm_last_error();
      EXPECT_EQ(f.offset, next) << f.name;
      EXPECT_GT(f.count, 0) << f.name;
      EXPECT_GT(std::strlen(f.unit), 0u) << f.name;
      EXPECT_TRUE(names.insert(f.name).second) << f.name;
      next += f.count;
    }
    EXPECT_EQ(next, task.obs_dim);
    EXPECT_EQ(rdm_task_field_at(t, task.num_fields, &f), RDM_ERROR_RANGE);
    EXPECT_EQ(rdm_task_field_at(t, -1, &f), RDM_ERROR_RANGE);
  }
}

TEST(Discovery, CostsOptionsCamerasAndDefaults) {
  const auto tasks = all_tasks();
  for (int32_t t = 0; t < rdm_task_count(); ++t) {
    const rdm_task& task = tasks[static_cast<size_t>(t)];
    SCOPED_TRACE(task.name);
    ASSERT_GE(task.cost_dim, 1);
    ASSERT_LE(task.cost_dim, RDM_MAX_COSTS);
    rdm_cost_info cost = RDM_INIT(rdm_cost_info);
    for (int32_t i = 0; i < task.cost_dim; ++i) {
      ASSERT_EQ(rdm_task_cost_at(t, i, &cost), RDM_OK);
      EXPECT_GT(std::strlen(cost.name), 0u);
      EXPECT_GT(std::strlen(cost.help), 0u);
      EXPECT_FALSE(std::isnan(cost.limit));
    }
    ASSERT_EQ(rdm_task_cost_at(t, 0, &cost), RDM_OK);
    EXPECT_GE(cost.limit, 0);
    EXPECT_EQ(rdm_task_cost_at(t, task.cost_dim, &cost), RDM_ERROR_RANGE);

    std::set<std::string> keys;
    rdm_option_spec option = RDM_INIT(rdm_option_spec);
    for (int32_t i = 0; i < task.num_options; ++i) {
      ASSERT_EQ(rdm_task_option_at(t, i, &option), RDM_OK);
      check_option(option, task.name);
      EXPECT_TRUE(keys.insert(option.key).second) << option.key;
    }
    EXPECT_EQ(rdm_task_option_at(t, task.num_options, &option), RDM_ERROR_RANGE);

    rdm_camera_info camera = RDM_INIT(rdm_camera_info);
    ASSERT_GE(task.num_cameras, 1);
    for (int32_t i = 0; i < task.num_cameras; ++i) {
      ASSERT_EQ(rdm_task_camera_at(t, i, &camera), RDM_OK);
      EXPECT_GT(camera.fov_y, 0.05f);
      EXPECT_LT(camera.fov_y, 3.1f);
      EXPECT_NE(std::memcmp(camera.eye, camera.target, sizeof camera.eye), 0);
    }
    EXPECT_EQ(rdm_task_camera_at(t, task.num_cameras, &camera), RDM_ERROR_RANGE);
  }
}

// Every algorithm must take what a task suggests, or a menu that joins the two would fail.
TEST(Discovery, DefaultsOfEveryTaskFitEveryAlgorithm) {
  const auto tasks = all_tasks();
  for (int32_t t = 0; t < rdm_task_count(); ++t) {
    std::vector<rdm_option> defaults(static_cast<size_t>(tasks[static_cast<size_t>(t)].num_defaults));
    for (size_t i = 0; i < defaults.size(); ++i)
      ASSERT_EQ(rdm_task_default_at(t, static_cast<int32_t>(i), &defaults[i]), RDM_OK);
    rdm_option past;
    EXPECT_EQ(rdm_task_default_at(t, static_cast<int32_t>(defaults.size()), &past), RDM_ERROR_RANGE);
    // they may name parts of the observation
    std::vector<rdm_field> fields;
    rdm_field_info f = RDM_INIT(rdm_field_info);
    for (int32_t i = 0; rdm_task_field_at(t, i, &f) == RDM_OK; ++i)
      fields.push_back({f.name, f.unit, f.offset, f.count});
    ASSERT_EQ(static_cast<int32_t>(fields.size()), tasks[static_cast<size_t>(t)].num_fields);
    for (int32_t a = 0; a < rdm_algo_count(); ++a) {
      rdm_algo algo;
      algo.struct_size = sizeof algo;
      ASSERT_EQ(rdm_algo_at(a, &algo), RDM_OK);
      rdm_agent_config config;
      rdm_agent_config_init(&config, sizeof config);
      config.algo = algo.name;
      config.action_dim = 2;
      config.num_envs = 2;
      config.fields = fields.data();
      config.num_fields = static_cast<int32_t>(fields.size());
      config.obs_dim = tasks[static_cast<size_t>(t)].obs_dim;
      config.defaults = defaults.data();
      config.num_defaults = static_cast<int32_t>(defaults.size());
      size_t bytes = 0;
      EXPECT_EQ(rdm_agent_config_memory(&config, &bytes), RDM_OK) << algo.name << ": " << rdm_last_error();
    }
  }
}

TEST(Discovery, TasksAreWhatTheirPoolsAre) {
  for (const rdm_task& task : all_tasks()) {
    SCOPED_TRACE(task.name);
    rdm_pool_config config;
    rdm_pool_config_init(&config, sizeof config);
    config.task = task.name;
    rdm_spec spec;
    spec.struct_size = sizeof spec;
    ASSERT_EQ(rdm_pool_config_spec(&config, &spec), RDM_OK) << rdm_last_error();
    EXPECT_EQ(spec.obs_dim, task.obs_dim);
    EXPECT_EQ(spec.action_dim, task.action_dim);
    EXPECT_EQ(spec.cost_dim, task.cost_dim);
    EXPECT_EQ(spec.max_steps, task.max_steps);
    EXPECT_EQ(spec.control_dt, task.control_dt);
    EXPECT_EQ(spec.num_fields, task.num_fields);
  }
}

TEST(Discovery, Algorithms) {
  ASSERT_GT(rdm_algo_count(), 0);
  for (int32_t a = 0; a < rdm_algo_count(); ++a) {
    rdm_algo algo;
    algo.struct_size = sizeof algo;
    ASSERT_EQ(rdm_algo_at(a, &algo), RDM_OK);
    EXPECT_GT(std::strlen(algo.summary), 0u);
    int32_t found = -1;
    EXPECT_EQ(rdm_algo_find(algo.name, &found), RDM_OK);
    EXPECT_EQ(found, a);
    std::set<std::string> keys;
    rdm_option_spec option = RDM_INIT(rdm_option_spec);
    for (int32_t i = 0; i < algo.num_options; ++i) {
      ASSERT_EQ(rdm_algo_option_at(a, i, &option), RDM_OK);
      check_option(option, algo.name);
      EXPECT_TRUE(keys.insert(option.key).second) << option.key;
    }
    EXPECT_EQ(rdm_algo_option_at(a, algo.num_options, &option), RDM_ERROR_RANGE);
  }
  int32_t found = -1;
  EXPECT_EQ(rdm_algo_find("ppo_lagg", &found), RDM_ERROR_NOT_FOUND);
  EXPECT_NE(std::string(rdm_last_error()).find("ppo_lag"), std::string::npos);
}

TEST(Discovery, RobotsAndObjects) {
  ASSERT_GE(rdm_robot_count(), 1);
  for (int32_t r = 0; r < rdm_robot_count(); ++r) {
    rdm_robot robot;
    robot.struct_size = sizeof robot;
    ASSERT_EQ(rdm_robot_at(r, &robot), RDM_OK);
    SCOPED_TRACE(robot.name);
    std::set<int32_t> actions;
    rdm_joint_info joint = RDM_INIT(rdm_joint_info);
    for (int32_t i = 0; i < robot.num_joints; ++i) {
      ASSERT_EQ(rdm_robot_joint_at(r, i, &joint), RDM_OK);
      EXPECT_LT(joint.lower, joint.upper) << joint.name;
      EXPECT_GT(joint.effort, 0) << joint.name;
      EXPECT_TRUE(joint.action < 0 || joint.kp > 0) << joint.name;
      EXPECT_TRUE(joint.action < 0 || actions.insert(joint.action).second) << joint.name;
    }
    EXPECT_EQ(static_cast<int32_t>(actions.size()), robot.num_actuated);
    if (actions.empty()) continue;  // a drawer, a door
    EXPECT_EQ(*actions.begin(), 0);
    EXPECT_EQ(*actions.rbegin(), robot.num_actuated - 1);
    EXPECT_EQ(rdm_robot_joint_at(r, robot.num_joints, &joint), RDM_ERROR_RANGE);
  }
  rdm_object_info object = RDM_INIT(rdm_object_info);
  ASSERT_GT(rdm_object_count(), 0);
  for (int32_t i = 0; i < rdm_object_count(); ++i) {
    ASSERT_EQ(rdm_object_info_at(i, &object), RDM_OK);
    EXPECT_GT(object.mass, 0) << object.name;
    EXPECT_GT(std::strlen(object.shape), 0u) << object.name;
    EXPECT_GT(std::strlen(object.summary), 0u) << object.name;
    EXPECT_GT(object.friction, 0) << object.name;
    EXPECT_EQ(object.own, 0) << object.name;
    EXPECT_EQ(object.kind<0, object.num_shapes> 1) << object.name;
    for (size_t k = 0; k < 3; ++k) EXPECT_LT(object.low[k], object.high[k]) << object.name;
  }
  EXPECT_EQ(rdm_object_info_at(rdm_object_count(), &object), RDM_ERROR_RANGE);
}

TEST(Discovery, SurvivesBadCalls) {
  int32_t index = 0;
  EXPECT_EQ(rdm_task_at(0, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_task_find(nullptr, &index), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_task_find("grasp", nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_task_field_at(0, 0, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_task_option_at(0, 0, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_algo_find(nullptr, &index), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_algo_option_at(0, 0, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_robot_at(0, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_object_info_at(0, nullptr), RDM_ERROR_ARGUMENT);
  rdm_task task;
  task.struct_size = 4;
  EXPECT_EQ(rdm_task_at(0, &task), RDM_ERROR_ARGUMENT);
  task.struct_size = sizeof task;
  EXPECT_EQ(rdm_task_at(rdm_task_count(), &task), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_task_at(-1, &task), RDM_ERROR_RANGE);
  rdm_field_info field = RDM_INIT(rdm_field_info);
  EXPECT_EQ(rdm_task_field_at(rdm_task_count(), 0, &field), RDM_ERROR_RANGE);
}

// `--set key=value` of the tool and the options of redman.train name an option without its owner. So what a task and an
// algorithm both have is action_repeat, which is the algorithm's, or has words, and no word is of both.
TEST(Discovery, AWordOfAnOptionSaysWhoseItIs) {
  std::set<std::string> of_tasks, of_algos;
  const auto add = [](std::set<std::string>& set, const rdm_option_spec& o) {
    if (o.kind != RDM_KIND_TEXT || !o.choices) {
      set.insert(o.key);
      return;
    }
    std::stringstream words(o.choices);
    for (std::string word; std::getline(words, word, '|');) set.insert(std::string(o.key) + "=" + word);
  };
  for (int32_t t = 0; t < rdm_task_count(); ++t) {
    rdm_option_spec o = RDM_INIT(rdm_option_spec);
    for (int32_t i = 0; rdm_task_option_at(t, i, &o) == RDM_OK; ++i) add(of_tasks, o);
  }
  for (int32_t a = 0; a < rdm_algo_count(); ++a) {
    rdm_option_spec o = RDM_INIT(rdm_option_spec);
    for (int32_t i = 0; rdm_algo_option_at(a, i, &o) == RDM_OK; ++i) add(of_algos, o);
  }
  std::set<std::string> both;
  std::set_intersection(of_tasks.begin(), of_tasks.end(), of_algos.begin(), of_algos.end(),
                        std::inserter(both, both.end()));
  EXPECT_EQ(both, std::set<std::string>{"action_repeat"});
}

}  // namespace
