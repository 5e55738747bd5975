// Robots, objects and tasks that a process adds and removes for as long as it lives.
#include <atomic>
#include <thread>

#include "called_task.hpp"
#include "contract.hpp"
#if defined(__GLIBC__)
#include <malloc.h>
#endif

namespace rdm::test {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr int32_t kMany = 5000;
#else
constexpr int32_t kMany = 100000;
#endif

// Bytes of the process's own heap that are in use; 0 where the C library does not tell.
size_t heap_in_use() {
#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  return mallinfo2().uordblks;
#else
  return 0;
#endif
}

rdm_result add_robot(const char* name, int32_t* number) {
  rdm_robot_link link{};
  link.name = "link", link.joint = "joint", link.parent = RDM_LINK_ROOT;
  link.pose.q[3] = 1, link.axis[2] = 1, link.lower = -1, link.upper = 1;
  link.kp = 1, link.kd = 0.1, link.effort = 1, link.mass = 1;
  for (int k = 0; k < 3; ++k) link.moment[k] = 0.1;
  rdm_robot_def d;
  EXPECT_EQ(rdm_robot_def_init(&d, sizeof d), RDM_OK);
  d.name = name, d.links = &link, d.num_links = 1;
  return rdm_robot_create(number, &d);
}
rdm_result robot_name(int32_t number, const char** name) {
  rdm_robot r{};
  r.struct_size = sizeof r;
  const rdm_result code = rdm_robot_at(number, &r);
  *name = r.name;
  return code;
}

rdm_result add_object(const char* name, int32_t* number) {
  rdm_shape_def s{};
  s.kind = RDM_SHAPE_BOX, s.size[0] = s.size[1] = s.size[2] = 0.02;
  rdm_object_def d;
  EXPECT_EQ(rdm_object_def_init(&d, sizeof d), RDM_OK);
  d.name = name, d.shapes = &s, d.num_shapes = 1, d.mass = 0.1;
  return rdm_object_create(number, &d);
}
rdm_result object_name(int32_t number, const char** name) {
  rdm_object_info o = RDM_INIT(rdm_object_info);
  const rdm_result code = rdm_object_info_at(number, &o);
  *name = o.name;
  return code;
}

CalledTask& pattern() {
  static CalledTask task("registries_pattern");
  return task;
}
rdm_result add_task(const char* name, int32_t* number) {
  rdm_task_def d = pattern().def;
  d.name = name;
  d.release = nullptr;
  return rdm_task_create(number, &d);
}
rdm_result task_name(int32_t number, const char** name) {
  rdm_task t{};
  t.struct_size = sizeof t;
  const rdm_result code = rdm_task_at(number, &t);
  *name = t.name;
  return code;
}

struct Kind {
  const char* what;
  rdm_result (*add)(const char* name, int32_t* number);
  rdm_result (*remove)(int32_t number);
  rdm_result (*name_of)(int32_t number, const char** name);
  int32_t (*count)();
};
const Kind kKinds[] = {{"robot", add_robot, rdm_robot_destroy, robot_name, rdm_robot_count},
                       {"object", add_object, rdm_object_destroy, object_name, rdm_object_count},
                       {"task", add_task, rdm_task_destroy, task_name, rdm_task_count}};

// What a program sees that looks for all of a kind.
std::vector<std::string> names_of(const Kind& kind) {
  std::vector<std::string> out;
  const char* name = nullptr;
  for (int32_t i = 0; i < kind.count(); ++i) {
    const rdm_result r = kind.name_of(i, &name);
    if (r == RDM_OK)
      out.emplace_back(name);
    else
      EXPECT_EQ(r, RDM_ERROR_NOT_FOUND) << kind.what << i;
  }
  return out;
}

TEST(Registries, AHundredThousandComeAndGo) {
  pattern();
  for (const Kind& kind : kKinds) {
    CountingHost host;
    ASSERT_EQ(rdm_init(&host.hooks), RDM_OK);
    int32_t first = -1, last = -1, kept = -1;
    const char* name = nullptr;
    const int32_t none = kind.count();
    std::vector<std::string> all = names_of(kind);
    all.emplace_back("kept");
    ASSERT_EQ(kind.add("kept", &kept), RDM_OK) << rdm_last_error();
    EXPECT_EQ(names_of(kind), all);
    const size_t live = host.live;
    size_t heap = 0;
    for (int32_t i = 0; i < kMany; ++i) {
      ASSERT_EQ(kind.add("passing", &last), RDM_OK) << kind.what << i << rdm_last_error();
      if (i == 0) first = last;
      ASSERT_EQ(last, first + i) << kind.what << ": no number comes twice";
      if (i == 100) heap = heap_in_use();
      if (i % 500 == 0) {
        ASSERT_EQ(kind.name_of(last, &name), RDM_OK);
        EXPECT_STREQ(name, "passing");
      }
      ASSERT_EQ(kind.remove(last), RDM_OK);
      ASSERT_EQ(host.live, live) << kind.what << ": what it took comes back";
    }
    EXPECT_LT(heap_in_use(), heap + 10000)
        << kind.what << ": memory follows what there is, not what there was";
    EXPECT_EQ(kind.count(), kept + 1);
    for (const int32_t gone : {first, first + kMany / 2, last}) {
      EXPECT_EQ(kind.name_of(gone, &name), RDM_ERROR_NOT_FOUND);
      EXPECT_EQ(std::string(rdm_last_error()),
                std::string(kind.what) + " " + std::to_string(gone) + " was destroyed");
      EXPECT_EQ(kind.remove(gone), RDM_ERROR_NOT_FOUND);
    }
    EXPECT_EQ(kind.name_of(last + 1, &name), RDM_ERROR_RANGE);
    int32_t newest = -1;
    ASSERT_EQ(kind.add("newest", &newest), RDM_OK);
    all.emplace_back("newest");
    EXPECT_EQ(names_of(kind), all) << "past all that were destroyed";
    EXPECT_EQ(kind.remove(newest), RDM_OK);
    EXPECT_EQ(kind.name_of(kept, &name), RDM_OK);
    EXPECT_STREQ(name, "kept");
    EXPECT_EQ(kind.add("kept", &last), RDM_ERROR_ARGUMENT) << "the name is taken";
    EXPECT_EQ(kind.remove(kept), RDM_OK);
    EXPECT_EQ(kind.count(), none);
    EXPECT_EQ(host.live, 0u);
    rdm_shutdown();
  }
}

// Every function that takes a number, with one of before that another thing of the same name followed.
TEST(Registries, ANumberThatWasKeptTooLongIsRefusedEverywhere) {
  pattern();
  int32_t robot = -1, object = -1, task = -1, next[3];
  ASSERT_EQ(add_robot("stale", &robot), RDM_OK);
  ASSERT_EQ(add_object("stale", &object), RDM_OK);
  ASSERT_EQ(add_task("stale", &task), RDM_OK);
  const std::string gone[] = {"robot " + std::to_string(robot) + " was destroyed",
                              "object " + std::to_string(object) + " was destroyed",
                              "task " + std::to_string(task) + " was destroyed"};
  ASSERT_EQ(rdm_robot_destroy(robot), RDM_OK);
  ASSERT_EQ(rdm_object_destroy(object), RDM_OK);
  ASSERT_EQ(rdm_task_destroy(task), RDM_OK);
  ASSERT_EQ(add_robot("stale", &next[0]), RDM_OK);
  ASSERT_EQ(add_object("stale", &next[1]), RDM_OK);
  ASSERT_EQ(add_task("stale", &next[2]), RDM_OK);
  int checked = 0;
  const auto refused = [&](const std::string& text, rdm_result r) {
    EXPECT_EQ(r, RDM_ERROR_NOT_FOUND) << checked;
    EXPECT_NE(std::string(rdm_last_error()).find(text), std::string::npos) << checked << rdm_last_error();
    ++checked;
  };
  double q[64] = {};
  rdm_pose poses[64];
  int32_t found = 0, made = 0;
  rdm_robot r{sizeof r, 0, 0, 0, nullptr, nullptr};
  rdm_joint_info joint = RDM_INIT(rdm_joint_info);
  rdm_robot_def rd;
  ASSERT_EQ(rdm_robot_def_init(&rd, sizeof rd), RDM_OK);
  rdm_robot_link link;
  rdm_robot_shape shape;
  rdm_robot_pair pair;
  rdm_robot_coupling coupling;
  rdm_robot_curve curve;
  rdm_robot_finger finger;
  refused(gone[0], rdm_robot_at(robot, &r));
  refused(gone[0], rdm_robot_joint_at(robot, 0, &joint));
  refused(gone[0], rdm_robot_get_def(robot, &rd));
  refused(gone[0], rdm_robot_link_at(robot, 0, &link));
  refused(gone[0], rdm_robot_shape_at(robot, 0, &shape));
  refused(gone[0], rdm_robot_pair_at(robot, 0, &pair));
  refused(gone[0], rdm_robot_coupling_at(robot, 0, &coupling));
  refused(gone[0], rdm_robot_curve_at(robot, 0, &curve));
  refused(gone[0], rdm_robot_finger_at(robot, 0, &finger));
  refused(gone[0], rdm_robot_get_postures(robot, nullptr, q, nullptr, nullptr));
  refused(gone[0], rdm_robot_get_poses(robot, q, poses, nullptr, nullptr, nullptr));
  refused(gone[0], rdm_robot_reach(robot, poses, q, &found));
  refused(gone[0], rdm_robot_create_mounted(&made, "mounted", robot, 0, 0, 0, 0));
  refused(gone[0], rdm_robot_create_mounted(&made, "mounted", next[0], robot, 0, 0, 0));
  refused(gone[0], rdm_robot_destroy(robot));
  rdm_object_info o = RDM_INIT(rdm_object_info);
  rdm_object_def od;
  ASSERT_EQ(rdm_object_def_init(&od, sizeof od), RDM_OK);
  rdm_shape_def body;
  refused(gone[1], rdm_object_info_at(object, &o));
  refused(gone[1], rdm_object_get_def(object, &od));
  refused(gone[1], rdm_object_shape_at(object, 0, &body));
  refused(gone[1], rdm_object_destroy(object));
  rdm_task t{};
  t.struct_size = sizeof t;
  rdm_field_info field = RDM_INIT(rdm_field_info);
  rdm_cost_info cost = RDM_INIT(rdm_cost_info);
  rdm_option_spec option = RDM_INIT(rdm_option_spec);
  rdm_camera_info camera = RDM_INIT(rdm_camera_info);
  rdm_option own;
  refused(gone[2], rdm_task_at(task, &t));
  refused(gone[2], rdm_task_field_at(task, 0, &field));
  refused(gone[2], rdm_task_cost_at(task, 0, &cost));
  refused(gone[2], rdm_task_option_at(task, 0, &option));
  refused(gone[2], rdm_task_camera_at(task, 0, &camera));
  refused(gone[2], rdm_task_default_at(task, 0, &own));
  refused(gone[2], rdm_task_destroy(task));
  // in a scene, where it is the error of making the pool
  CalledTask scene("registries_scene");
  rdm_pool_config c = pool_config(1);
  c.task = "registries_scene";
  rdm_pool* pool = nullptr;
  scene.build = [&](rdm_scene* s) {
    rdm_scene_robot row;
    EXPECT_EQ(rdm_scene_robot_init(&row, sizeof row), RDM_OK);
    row.robot = robot, row.name = "r";
    return rdm_scene_add_robot(s, &row, nullptr);
  };
  refused(gone[0], rdm_pool_create(&pool, &c));
  const rdm_pose above{{0, 0, 1}, {}};
  scene.build = [&](rdm_scene* s) { return rdm_scene_add_object(s, object, "o", &above, 1, nullptr); };
  refused(gone[1], rdm_pool_create(&pool, &c));
  EXPECT_EQ(checked, 28);
  // by name: the one that there is
  scene.build = nullptr;
  c.task = "stale";
  pool = make_pool(c);
  EXPECT_EQ(spec_of(pool).task, next[2]);
  rdm_pool_destroy(pool);
  c.task = "grasp";
  c.settings = "object=stale";
  rdm_pool_destroy(make_pool(c));
  ASSERT_EQ(rdm_robot_destroy(next[0]), RDM_OK);
  ASSERT_EQ(rdm_object_destroy(next[1]), RDM_OK);
  ASSERT_EQ(rdm_task_destroy(next[2]), RDM_OK);
  pool = nullptr;
  EXPECT_EQ(rdm_pool_create(&pool, &c), RDM_ERROR_NOT_FOUND);
  c.task = "stale";
  c.settings = nullptr;
  EXPECT_EQ(rdm_pool_create(&pool, &c), RDM_ERROR_NOT_FOUND);
  EXPECT_EQ(pool, nullptr);
}

// What is used stays while others go by.
TEST(Registries, AUsedOneStays) {
  CalledTask task("registries_used");
  rdm_pool_config c = pool_config(1);
  c.task = "registries_used";
  rdm_pool* const pool = make_pool(c);
  ASSERT_EQ(rdm_task_destroy(task.number), RDM_OK);
  int32_t number = -1;
  for (int i = 0; i < 100; ++i) {
    ASSERT_EQ(add_task("registries_used", &number), RDM_OK);
    ASSERT_EQ(rdm_task_destroy(number), RDM_OK);
  }
  EXPECT_EQ(rdm_pool_reset(pool, nullptr, nullptr), RDM_OK);
  EXPECT_EQ(rdm_pool_step(pool), RDM_OK);
  rdm_pool_destroy(pool);
}

// Names that one thread was given are read while another removes what had them.
TEST(Registries, NamesOfRemovedThingsStay) {
  pattern();
  for (const Kind& kind : kKinds) {
    std::atomic<int32_t> newest = kind.count() - 1;
    std::atomic<bool> done = false;
    std::vector<const char*> seen;
    std::thread reader([&] {
      while (!done) {
        const char* name = nullptr;
        if (kind.name_of(newest, &name) == RDM_OK) seen.push_back(name);
        for (size_t i = seen.size() > 20 ? seen.size() - 20 : 0; i < seen.size(); ++i)
          EXPECT_GT(std::strlen(seen[i]), 0u);
        std::this_thread::yield();
      }
    });
    for (int i = 0; i < 1500; ++i) {
      int32_t number = -1;
      const std::string name = "a_passing_name_" + std::to_string(i % 7);
      ASSERT_EQ(kind.add(name.c_str(), &number), RDM_OK) << rdm_last_error();
      newest = number;
      if (i % 8 == 0) std::this_thread::sleep_for(std::chrono::microseconds(20));
      ASSERT_EQ(kind.remove(number), RDM_OK);
    }
    done = true;
    reader.join();
    for (const char* name : seen) EXPECT_GT(std::strlen(name), 0u);
    std::printf("%s: %zu names read\n", kind.what, seen.size());
  }
  // equal texts are kept once
  const char *a = nullptr, *b = nullptr;
  int32_t number = -1;
  ASSERT_EQ(add_object("a_passing_name_3", &number), RDM_OK);
  ASSERT_EQ(object_name(number, &a), RDM_OK);
  ASSERT_EQ(rdm_object_destroy(number), RDM_OK);
  ASSERT_EQ(add_object("a_passing_name_3", &number), RDM_OK);
  ASSERT_EQ(object_name(number, &b), RDM_OK);
  ASSERT_EQ(rdm_object_destroy(number), RDM_OK);
  EXPECT_EQ(a, b);
  EXPECT_STREQ(a, "a_passing_name_3");
}

}  // namespace
}  // namespace rdm::test
