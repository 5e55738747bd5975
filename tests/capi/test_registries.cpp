// Robots, objects and tasks that a process adds and removes for as long as it lives.
#include <atomic>
#include <thread>

#include "called_task.hpp"
#include "contract.hpp"

namespace rdm::test {
namespace {

constexpr int32_t kMany = 5000;

rdm_result add_robot(const char* name, int32_t* number) {
  rdm_robot_link link{};
  link.name = "link", link.joint = "joint", link.parent = RDM_LINK_ROOT;
  link.q[3] = 1, link.axis[2] = 1, link.lower = -1, link.upper = 1;
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
  rdm_object o{};
  const rdm_result code = rdm_object_at(number, &o);
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

TEST(Registries, ThousandsComeAndGo) {
  pattern();
  for (const Kind& kind : kKinds) {
    CountingHost host;
    ASSERT_EQ(rdm_init(&host.hooks), RDM_OK);
    int32_t first = -1, last = -1, kept = -1;
    const char* name = nullptr;
    ASSERT_EQ(kind.add("kept", &kept), RDM_OK) << rdm_last_error();
    const size_t live = host.live;
    for (int32_t i = 0; i < kMany; ++i) {
      ASSERT_EQ(kind.add("passing", &last), RDM_OK) << kind.what << i << rdm_last_error();
      if (i == 0) first = last;
      ASSERT_EQ(last, first + i) << kind.what << ": no number comes twice";
      if (i % 500 == 0) {
        ASSERT_EQ(kind.name_of(last, &name), RDM_OK);
        EXPECT_STREQ(name, "passing");
      }
      ASSERT_EQ(kind.remove(last), RDM_OK);
      ASSERT_EQ(host.live, live) << kind.what << ": what it took comes back";
    }
    EXPECT_EQ(kind.count(), last + 1);
    for (const int32_t gone : {first, first + kMany / 2, last}) {
      EXPECT_EQ(kind.name_of(gone, &name), RDM_ERROR_NOT_FOUND);
      EXPECT_EQ(std::string(rdm_last_error()),
                std::string(kind.what) + " " + std::to_string(gone) + " was removed");
      EXPECT_EQ(kind.remove(gone), RDM_ERROR_NOT_FOUND);
    }
    EXPECT_EQ(kind.name_of(last + 1, &name), RDM_ERROR_RANGE);
    EXPECT_EQ(kind.name_of(kept, &name), RDM_OK);
    EXPECT_STREQ(name, "kept");
    EXPECT_EQ(kind.add("kept", &last), RDM_ERROR_ARGUMENT) << "the name is taken";
    EXPECT_EQ(kind.remove(kept), RDM_OK);
    EXPECT_EQ(host.live, 0u);
    rdm_shutdown();
  }
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
