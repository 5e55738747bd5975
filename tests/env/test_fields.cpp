#include <limits>

#include "toy_task.hpp"

namespace rdm::test {
namespace {

FieldTable small_table() {
  FieldTable t;
  add_field(t, "right", "joint", "1", 2);
  add_field(t, nullptr, "goal", "m", 3);
  return t;
}

TEST(Fields, NamesAndTotal) {
  const FieldTable t = small_table();
  EXPECT_TRUE(t[0].name == "right.joint");
  EXPECT_TRUE(t[1].name == "goal");
  EXPECT_EQ(field_total(t), 5);
}

TEST(Fields, NamesMustFit) {
  FieldTable t;
  EXPECT_EQ(code_of([&] { add_field(t, "a_rather_long_prefix", "and_a_long_name", "1", 1); }),
            Code::kInternal);
  EXPECT_EQ(code_of([&] { add_field(t, nullptr, "none", "1", 0); }), Code::kInternal);
}

struct Source {
  float joint, goal;
};
constexpr FieldEntry<Source> kEntries[] = {
    {"joint", "1", 2, [](const Source& s, float* out) { out[0] = out[1] = s.joint; }},
    {"goal", "m", 3, [](const Source& s, float* out) { out[0] = out[1] = out[2] = s.goal; }},
};

TEST(Fields, EntriesAreWrittenOneBehindTheOther) {
  float row[6] = {};
  row[5] = -1;
  EXPECT_EQ(write_fields<kEntries>(Source{7, 9}, row), row + 5);
  const float expected[] = {7, 7, 9, 9, 9, -1};
  for (int i = 0; i < 6; ++i) EXPECT_EQ(row[i], expected[i]) << i;
}

TEST(Fields, QuaternionsAreScalarLast) {
  float out[4];
  put(Quat{0.5, 0.1, 0.2, 0.3}, out);
  EXPECT_EQ(out[0], 0.1f);
  EXPECT_EQ(out[3], 0.5f);
  put(Vec3{1, 2, 3}, out, 0.2);
  EXPECT_EQ(out[2], static_cast<float>(0.2 * 3));
}

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

TEST(Fields, ClippingKeepsWhatIsNotANumber) {
  float row[] = {7, -7, 4.5f, kNan, kInf, -kInf};
  EXPECT_FALSE(clip_row(row, 6, 5));
  EXPECT_EQ(row[0], 5);
  EXPECT_EQ(row[1], -5);
  EXPECT_EQ(row[2], 4.5f);
  EXPECT_NE(row[3], row[3]);
  EXPECT_EQ(row[4], 5);
  EXPECT_EQ(row[5], -5);
}

// At every place of a row: the loop takes several entries at a time and a rest.
TEST(Fields, ClippingTellsWhetherAllIsFinite) {
  for (int count = 1; count < 20; ++count)
    for (int at = 0; at < count; ++at)
      for (const float bad : {kNan, -kNan, kInf, -kInf}) {
        float row[20], out[20];
        for (float& x : row) x = 3e38f;
        EXPECT_TRUE(clip_row(row, count, kInf));
        EXPECT_TRUE(clip_action(row, count, out));
        row[at] = bad;
        EXPECT_FALSE(clip_row(row, count, kInf)) << count << " " << at;
        EXPECT_FALSE(clip_action(row, count, out)) << count << " " << at;
        EXPECT_EQ(clip_row(row, count, 5), bad == bad);  // an infinity is bounded
      }
}

TEST(Fields, ActionsAreBoundedByOne) {
  const float row[] = {-3, -1, -0.0f, 0.25f, 1, 1.5f};
  const float expected[] = {-1, -1, 0, 0.25f, 1, 1};
  float out[6];
  EXPECT_TRUE(clip_action(row, 6, out));
  for (int i = 0; i < 6; ++i) EXPECT_EQ(out[i], expected[i]) << i;
}

// A task with other fields, order or actions has another layout.
class Layout final : public Task {
 public:
  FieldTable table;
  const char* order = "a, b";
  int32_t actions = 2;
  Scene unused;
  const Scene& scene() const override { return unused; }
  EngineKind engine() const override { return EngineKind::kOde; }
  int32_t max_steps() const override { return 1; }
  int32_t action_dim() const override { return actions; }
  const Vector<FieldSpec>& fields() const override { return table; }
  const char* action_order() const override { return order; }
  size_t state_bytes() const override { return 0; }
  void check_state(const void*) const override {}
  void reset(World&, void*, Stream&) const override {}
  void control(World&, void*, const float*) const override {}
  Verdict judge(World&, void*, int32_t) const override { return {}; }
  void observe(const World&, const void*, float*) const override {}
  void hold_action(float*) const override {}
  void initial_mean(float*) const override {}
};

TEST(Fields, LayoutHashSeesNamesCountsOrderAndActions) {
  Layout a;
  a.table = small_table();
  const uint64_t hash = layout_hash(a);
  EXPECT_EQ(layout_hash(a), hash);
  EXPECT_EQ(obs_dim(a), 5);
  Layout b;
  b.table = small_table();
  EXPECT_EQ(layout_hash(b), hash);
  b.table[0].count = 3;
  EXPECT_NE(layout_hash(b), hash);
  b.table = small_table();
  b.table[1].name = "gaol";
  EXPECT_NE(layout_hash(b), hash);
  b.table = small_table();
  b.order = "b, a";
  EXPECT_NE(layout_hash(b), hash);
  b.order = a.order;
  b.actions = 3;
  EXPECT_NE(layout_hash(b), hash);
  b.actions = 2;
  b.table[0].unit = "km";  // a unit is words, not layout
  EXPECT_EQ(layout_hash(b), hash);
}

}  // namespace
}  // namespace rdm::test
