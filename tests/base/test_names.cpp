#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <vector>

#include "base/name_index.hpp"
#include "base/names.hpp"

namespace rdm {
namespace {

TEST(NearestName, ByEditDistance) {
  const char* names[] = {"ppo", "ppo_lag", "trpo", "cpo"};
  EXPECT_EQ(nearest_name("ppolag", names, 4), 1);
  EXPECT_EQ(nearest_name("TRPO", names, 4), 2);
  EXPECT_EQ(nearest_name("trpoo", names, 4), 2);
  EXPECT_EQ(nearest_name("trop", names, 4), 2);  // two letters swapped
  EXPECT_EQ(nearest_name("cp", names, 4), 3);
  const char* longer[] = {"bandit", "hand_over_safe_finger"};
  EXPECT_EQ(nearest_name("hand_over", longer, 2), 1);  // it begins so
  for (const char* far : {"c", "nonsense", "xyz", "", "a_name_that_is_far_longer_than_any"})
    EXPECT_EQ(nearest_name(far, names, 4), -1) << far;
  EXPECT_STREQ(Nearest("ppolag", names, 4).text, "; nearest is ppo_lag");
  EXPECT_STREQ(Nearest("nonsense", names, 4).text, "");
  EXPECT_EQ(nearest_name("x", names, 0), -1);
}

std::string nearest(const char* word, const std::vector<const char*>& names) {
  return Nearest(word, names.data(), static_cast<int32_t>(names.size())).text;
}

TEST(Nearest, OffersAWholeFamilyToItsBeginning) {
  const std::vector<const char*> tasks = {"hand_over_safe_finger",
                                          "hand_over_safe_joint",
                                          "catch_underarm_safe_finger",
                                          "hand_over_wall",
                                          "pick_bottles",
                                          "grasp",
                                          "clean_house",
                                          "ant_run",
                                          "ant_velocity",
                                          "ant_circle",
                                          "ant_gather"};
  const char* thrown = "; nearest are hand_over_safe_finger, hand_over_safe_joint and hand_over_wall";
  EXPECT_EQ(nearest("hand_ovr", tasks), thrown);
  EXPECT_EQ(nearest("hand_over", tasks), thrown);
  EXPECT_EQ(nearest("Hand-Over", tasks), thrown);
  EXPECT_EQ(nearest("hand_over_safe", tasks), "; nearest are hand_over_safe_finger and hand_over_safe_joint");
  EXPECT_EQ(nearest("hand_over_safe_fingr", tasks), "; nearest is hand_over_safe_finger");
  EXPECT_EQ(nearest("hand_over_wal", tasks), "; nearest is hand_over_wall");
  EXPECT_EQ(nearest("ant", tasks), "; nearest are ant_run, ant_velocity, ant_circle and 1 more");
}

TEST(Nearest, OffersWhatHasTheWordAmongItsParts) {
  const std::vector<const char*> names = {"pick_bottles", "ppo_lag", "trpo_lag", "cppo_pid",
                                          "right.object_mass"};
  EXPECT_EQ(nearest("bottles", names), "; nearest is pick_bottles");
  EXPECT_EQ(nearest("botles", names), "; nearest is pick_bottles");
  EXPECT_EQ(nearest("lag", names), "; nearest are ppo_lag and trpo_lag");
  EXPECT_EQ(nearest("mass", names), "; nearest is right.object_mass");
  EXPECT_EQ(nearest("zebra", names), "");
}

TEST(Nearest, OffersANameThatStandsTwiceOnce) {
  EXPECT_EQ(nearest("bll", {"ball", "cup", "ball", "Ball"}), "; nearest is ball");
}

TEST(Nearest, OffersTheNameThatTheWordGoesOnFrom) {
  EXPECT_EQ(nearest("hidden_sizes_of_all", {"hid", "hidden", "clip"}), "; nearest is hidden");
}

TEST(Nearest, KeepsItsBoundsWhateverTheNames) {
  const std::string longest(5000, 'a'), part = [] {
    std::string s;
    for (int i = 0; i < 2000; ++i) s += "a_";
    return s;
  }();
  const std::vector<const char*> names(100000, part.c_str());
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_LT(nearest(longest.c_str(), names).size(), sizeof(Nearest::text));
  EXPECT_LT(nearest("a_a_a_a_a_b", {longest.c_str(), part.c_str(), "a_a_a"}).size(), sizeof(Nearest::text));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5));
}

TEST(NameIndex, FindsEachNameHoweverItIsSpelt) {
  std::vector<std::string> names;
  for (int i = 0; i < 500; ++i) names.push_back("joint.robot_" + std::to_string(i * 7) + ".kp");
  std::vector<NameSlot> slots(1024);
  const auto name_of = [&](int32_t i) { return names[static_cast<size_t>(i)].c_str(); };
  EXPECT_EQ(find_indexed(slots.data(), 0, "joint", name_of), -1);
  EXPECT_EQ(find_indexed(slots.data(), slots.size(), "joint", name_of), -1);
  for (int32_t i = 0; i < 500; ++i) add_indexed(slots.data(), slots.size(), name_of(i), i);
  for (int32_t i = 0; i < 500; ++i) {
    const std::string typed = "Joint.ROBOT-" + std::to_string(i * 7) + ".KP";
    EXPECT_EQ(find_indexed(slots.data(), slots.size(), typed.c_str(), name_of), i);
  }
  for (const char* other : {"", "joint.robot_1.kp", "joint.robot_7.kpp", "joint.robot_7"})
    EXPECT_EQ(find_indexed(slots.data(), slots.size(), other, name_of), -1) << other;
}

}  // namespace
}  // namespace rdm
