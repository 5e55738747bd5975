// Recordings through the C ABI: of a pool, of a host's own rows, as files, as starts of episodes, as a
// teacher.
#include <cmath>
#include <cstdio>
#include <set>

#include "contract.hpp"

namespace {

struct Owned {
  rdm_recording* r = nullptr;
  ~Owned() { rdm_recording_destroy(r); }
};

rdm_recording_info info_of(const rdm_recording* r) {
  rdm_recording_info i{};
  i.struct_size = sizeof i;
  EXPECT_EQ(rdm_recording_get_info(r, &i), RDM_OK) << rdm_last_error();
  return i;
}

rdm_recording_rows rows_of(const rdm_recording* r) {
  rdm_recording_rows v{};
  v.struct_size = sizeof v;
  EXPECT_EQ(rdm_recording_get_rows(r, &v), RDM_OK);
  return v;
}

// Random actions as what is done, 0.25 as what was meant.
void record(rdm_recording* r, rdm_pool* p, int steps, bool labels = true) {
  const rdm_buffers b = buffers_of(p);
  const rdm_spec s = spec_of(p);
  std::vector<float> label(4 * static_cast<size_t>(s.action_dim), 0.25f);
  for (int i = 0; i < steps; ++i) {
    ASSERT_EQ(rdm_pool_baseline(p, RDM_BASELINE_RANDOM), RDM_OK);
    ASSERT_EQ(rdm_recording_begin_step(r, p, labels ? label.data() : nullptr, nullptr), RDM_OK)
        << rdm_recording_error(r);
    ASSERT_EQ(rdm_pool_step(p), RDM_OK);
    ASSERT_EQ(rdm_recording_end_step(r, p, nullptr), RDM_OK);
  }
  (void)b;
}

rdm_recording* recording_for(const rdm_pool* p, int32_t stride = 4, const rdm_host* host = nullptr) {
  rdm_recording_config c;
  EXPECT_EQ(rdm_recording_config_init(&c, sizeof c), RDM_OK);
  EXPECT_EQ(rdm_recording_config_for_pool(&c, p), RDM_OK);
  c.state_stride = stride;
  c.host = host;
  rdm_recording* r = nullptr;
  EXPECT_EQ(rdm_recording_create(&r, &c), RDM_OK) << rdm_last_error();
  return r;
}

struct Worlds {
  rdm_pool* pool = nullptr;
  explicit Worlds(uint64_t seed = 0, int32_t threads = 0, int32_t autoreset = RDM_AUTORESET_SAME_STEP) {
    rdm_pool_config c = pool_config(4);
    c.task = "ball_run";
    c.seed = seed;
    c.num_threads = threads;
    c.autoreset = autoreset;
    pool = make_pool(c);
    EXPECT_EQ(rdm_pool_reset(pool, nullptr, nullptr), RDM_OK);
  }
  ~Worlds() { rdm_pool_destroy(pool); }
};

std::string file_path() {
  return testing::TempDir() + "redman_recording.npz";
}

// A world whose episode has ended has no row until it is reset, whatever mask is given.
TEST(ContractRecording, WorldsWithoutAnEpisodeHaveNoRows) {
  const Worlds w(0, 0, RDM_AUTORESET_OFF);
  const Owned o{recording_for(w.pool, 4)};
  const rdm_buffers b = buffers_of(w.pool);
  int32_t running = 4;
  std::vector<uint8_t> mask(4, 1);
  double sum = 0, recorded = 0;
  while (running > 0) {
    ASSERT_EQ(rdm_pool_baseline(w.pool, RDM_BASELINE_RANDOM), RDM_OK);
    ASSERT_EQ(rdm_recording_begin_step(o.r, w.pool, nullptr, nullptr), RDM_OK);
    ASSERT_EQ(rdm_pool_step_masked(w.pool, mask.data()), RDM_OK);
    ASSERT_EQ(rdm_recording_end_step(o.r, w.pool, nullptr), RDM_OK);
    for (size_t i = 0; i < 4; ++i) {
      if (!mask[i]) continue;
      sum += static_cast<double>(b.reward[i]);
      if (b.terminated[i] || b.truncated[i]) mask[i] = 0, --running;
    }
  }
  ASSERT_EQ(rdm_recording_begin_step(o.r, w.pool, nullptr, nullptr), RDM_OK);
  EXPECT_EQ(info_of(o.r).episodes, 4);
  const rdm_recording_rows v = rows_of(o.r);
  for (int64_t i = 0; i < v.rows; ++i) recorded += static_cast<double>(v.reward[i]);
  EXPECT_NEAR(recorded, sum, 1e-4 * std::abs(sum));
  rdm_pool* fresh = make_pool(pool_config(4));
  const Owned other{recording_for(fresh, 4)};
  EXPECT_EQ(rdm_recording_begin_step(other.r, fresh, nullptr, nullptr), RDM_ERROR_STATE);
  rdm_pool_destroy(fresh);
}

TEST(ContractRecording, DataThatItHasNoPlaceForAreRefused) {
  rdm_recording_config c;
  ASSERT_EQ(rdm_recording_config_init(&c, sizeof c), RDM_OK);
  c.obs_dim = c.action_dim = 1;
  rdm_recording* r = nullptr;
  c.point_color = 1;
  EXPECT_EQ(rdm_recording_create(&r, &c), RDM_ERROR_ARGUMENT);
  c.point_color = 0;
  ASSERT_EQ(rdm_recording_create(&r, &c), RDM_OK);
  const Owned o{r};
  const float one = 1;
  const uint8_t kind = 1;
  rdm_recording_rows v{};
  v.struct_size = sizeof v;
  v.rows = 1;
  v.obs = v.action = &one;
  v.cost = &one;
  EXPECT_EQ(rdm_recording_append(r, &v), RDM_ERROR_ARGUMENT);
  v.cost = nullptr;
  v.point_class = &kind;
  EXPECT_EQ(rdm_recording_append(r, &v), RDM_ERROR_ARGUMENT);
  v.point_class = nullptr;
  EXPECT_EQ(rdm_recording_append(r, &v), RDM_OK);
}

}  // namespace

TEST(ContractRecording, APoolsRows) {
  Worlds w;
  const rdm_buffers b = buffers_of(w.pool);
  Owned o{recording_for(w.pool)};
  const std::vector<float> first(b.obs, b.obs + 4);
  record(o.r, w.pool, 30);
  const rdm_recording_info i = info_of(o.r);
  EXPECT_EQ(i.rows, 120);
  EXPECT_STREQ(i.task, "ball_run");
  EXPECT_EQ(i.num_states, 32);  // of steps 0, 4 ... 28
  const rdm_recording_rows v = rows_of(o.r);
  EXPECT_EQ(std::vector<float>(v.obs, v.obs + 4), first);
  EXPECT_EQ(v.label[0], 0.25f);
  EXPECT_NE(v.action[0], 0.25f);
  EXPECT_EQ(v.reward[119], b.reward[3]);
  EXPECT_EQ(v.episode[119], 3);
  // a state is one that a pool takes, and goes on from as it did
  Worlds other(9);
  ASSERT_EQ(rdm_pool_read_state(other.pool, 0, v.state + 28 * i.state_bytes, i.state_bytes), RDM_OK);
  const int64_t row = v.state_row[28];
  const rdm_buffers c = buffers_of(other.pool);
  EXPECT_EQ(std::memcmp(c.obs, v.obs + row * i.obs_dim, sizeof(float) * static_cast<size_t>(i.obs_dim)), 0);
  std::memcpy(c.action, v.action + row * i.action_dim, sizeof(float) * static_cast<size_t>(i.action_dim));
  ASSERT_EQ(rdm_pool_step(other.pool), RDM_OK);
  EXPECT_EQ(c.reward[0], v.reward[row]);
}

// The step of a pool that only resets a world makes no row, and each end a new episode.
TEST(ContractRecording, EpisodesOfBothAutoresets) {
  for (const int32_t mode : {RDM_AUTORESET_SAME_STEP, RDM_AUTORESET_NEXT_STEP}) {
    Worlds w(1, 0, mode);
    const rdm_buffers b = buffers_of(w.pool);
    const rdm_spec s = spec_of(w.pool);
    Owned o{recording_for(w.pool, 1 << 20)};
    record(o.r, w.pool, s.max_steps + 20, false);
    const rdm_recording_info i = info_of(o.r);
    EXPECT_GE(i.episodes, 8);
    EXPECT_EQ(i.num_states, i.episodes);
    const rdm_recording_rows v = rows_of(o.r);
    int64_t ends = 0;
    for (int64_t k = 0; k < i.rows; ++k) ends += v.terminated[k] || v.truncated[k];
    EXPECT_EQ(i.rows, 4 * (s.max_steps + 20) - (mode == RDM_AUTORESET_NEXT_STEP ? ends : 0));
    EXPECT_EQ(i.episodes, ends + 4);
    (void)b;
  }
}

TEST(ContractRecording, FilesAndNumpy) {
  Worlds w;
  Owned o{recording_for(w.pool)}, back;
  record(o.r, w.pool, 12);
  const std::string path = file_path();
  ASSERT_EQ(rdm_recording_write_file(o.r, path.c_str()), RDM_OK) << rdm_last_error();
  ASSERT_EQ(rdm_recording_read_file(&back.r, path.c_str()), RDM_OK) << rdm_last_error();
  EXPECT_EQ(info_of(back.r).fingerprint, info_of(o.r).fingerprint);
  EXPECT_EQ(info_of(back.r).rows, 48);
  rdm_recording* none = nullptr;
  EXPECT_EQ(rdm_recording_read_file(&none, "/nowhere/x.npz"), RDM_ERROR_NOT_FOUND);

  // numpy reads it, and what numpy writes is read; where there is no numpy there is nothing to hold it to
  const std::string
      again = testing::TempDir() + "redman_recording_again.npz",
      script =
          "import sys, numpy as n\n"
          "a = n.load(sys.argv[1])\n"
          "assert a['obs'].shape[0] == 48 and a['obs'].dtype == n.float32\n"
          "assert a['task'].item() == b'ball_run' and a['success'].dtype == bool\n"
          "assert (a['label'] == 0.25).all() and a['state'].shape[0] == len(a['state_row']) == 12\n"
          "assert a['episode'].max() == 3 and a['layout_hash'] > 0\n"
          "n.savez(sys.argv[2], **{k: a[k] for k in a.files})\n"
          "n.savez_compressed(sys.argv[1], **{k: a[k] for k in a.files})\n";
  const std::string file = testing::TempDir() + "redman_recording.py";
  FILE* f = std::fopen(file.c_str(), "w");
  ASSERT_NE(f, nullptr);
  std::fputs(script.c_str(), f);
  std::fclose(f);
  if (std::system("/usr/bin/python3 -c 'import numpy' 2> /dev/null") != 0) GTEST_SKIP() << "no numpy";
  ASSERT_EQ(std::system(("/usr/bin/python3 " + file + " " + path + " " + again).c_str()), 0);
  Owned third;
  ASSERT_EQ(rdm_recording_read_file(&third.r, again.c_str()), RDM_OK) << rdm_last_error();
  EXPECT_EQ(info_of(third.r).fingerprint, info_of(o.r).fingerprint);
  EXPECT_EQ(info_of(third.r).num_states, 12);
  EXPECT_EQ(rdm_recording_read_file(&none, path.c_str()), RDM_ERROR_FORMAT);
  EXPECT_NE(std::string(rdm_last_error()).find("compressed"), std::string::npos) << rdm_last_error();
}

// A share of 0, and no states, change nothing; other draws stay with any.
TEST(ContractRecording, EpisodesBeginAtItsStates) {
  Worlds demo(3);
  Owned o{recording_for(demo.pool, 10)};
  record(o.r, demo.pool, 200);
  const rdm_recording_rows v = rows_of(o.r);
  const rdm_recording_info i = info_of(o.r);
  std::set<std::vector<float>> states;
  const auto width = static_cast<size_t>(i.obs_dim);
  for (int64_t k = 0; k < v.num_states; ++k) {
    const float* row = v.obs + static_cast<size_t>(v.state_row[k]) * width;
    states.insert(std::vector<float>(row, row + width));
  }
  const auto begun = [&](double share, int resets) {
    Worlds w(11);
    EXPECT_EQ(rdm_pool_set_starts(w.pool, o.r, 0.5), RDM_OK) << rdm_pool_error(w.pool);
    EXPECT_EQ(rdm_pool_set_starts(w.pool, nullptr, share), RDM_OK);
    const rdm_buffers b = buffers_of(w.pool);
    std::vector<std::vector<float>> out;
    for (int k = 0; k < resets; ++k) {
      EXPECT_EQ(rdm_pool_reset(w.pool, nullptr, nullptr), RDM_OK);
      for (size_t e = 0; e < 4; ++e) out.emplace_back(b.obs + e * width, b.obs + (e + 1) * width);
    }
    return out;
  };
  const auto none = begun(0, 50), some = begun(0.3, 50), all = begun(1, 50);
  size_t drawn = 0;
  for (size_t k = 0; k < none.size(); ++k) {
    EXPECT_EQ(states.count(all[k]), 1u);
    drawn += states.count(some[k]);
    if (!states.count(some[k])) {
      EXPECT_EQ(some[k], none[k]);
    }
  }
  EXPECT_GT(drawn, 30u);
  EXPECT_LT(drawn, 95u);
  Worlds plain(11);
  const rdm_buffers b = buffers_of(plain.pool);
  ASSERT_EQ(rdm_pool_reset(plain.pool, nullptr, nullptr), RDM_OK);
  EXPECT_EQ(std::vector<float>(b.obs, b.obs + width), none[0]);
}

TEST(ContractRecording, StartsResumeAndDoNotFollowThreads) {
  Worlds demo(3);
  Owned o{recording_for(demo.pool, 10)}, other{recording_for(demo.pool, 10)};
  record(o.r, demo.pool, 60);
  record(other.r, demo.pool, 30);
  const rdm_spec s = spec_of(demo.pool);
  const auto play = [](rdm_pool* p, int steps) {
    for (int i = 0; i < steps; ++i) {
      ASSERT_EQ(rdm_pool_baseline(p, RDM_BASELINE_RANDOM), RDM_OK);
      ASSERT_EQ(rdm_pool_step(p), RDM_OK);
    }
  };
  Worlds a(5), b(6, 3);
  ASSERT_EQ(rdm_pool_set_starts(a.pool, o.r, 0.6), RDM_OK);
  ASSERT_EQ(rdm_pool_reset(a.pool, nullptr, nullptr), RDM_OK);
  play(a.pool, s.max_steps + 5);
  std::vector<unsigned char> state;
  size_t n = 0;
  ASSERT_EQ(rdm_pool_write_state(a.pool, -1, nullptr, 0, &n), RDM_OK);
  state.resize(n);
  ASSERT_EQ(rdm_pool_write_state(a.pool, -1, state.data(), n, &n), RDM_OK);
  const uint64_t before = hash_of(b.pool);
  EXPECT_EQ(rdm_pool_read_state(b.pool, -1, state.data(), n), RDM_ERROR_FORMAT);
  ASSERT_EQ(rdm_pool_set_starts(b.pool, other.r, 0.1), RDM_OK);
  EXPECT_EQ(rdm_pool_read_state(b.pool, -1, state.data(), n), RDM_ERROR_FORMAT);
  EXPECT_EQ(hash_of(b.pool), before);
  ASSERT_EQ(rdm_pool_set_starts(b.pool, o.r, 0.1), RDM_OK);
  ASSERT_EQ(rdm_pool_read_state(b.pool, -1, state.data(), n), RDM_OK) << rdm_pool_error(b.pool);
  play(a.pool, 2 * s.max_steps), play(b.pool, 2 * s.max_steps);
  EXPECT_EQ(hash_of(a.pool), hash_of(b.pool));
}

TEST(ContractRecording, StartsThatAreNoneAreRefused) {
  Worlds w(5);
  Owned o{recording_for(w.pool, 10)};
  EXPECT_EQ(rdm_pool_set_starts(w.pool, o.r, 0.5), RDM_ERROR_ARGUMENT);  // it has no states yet
  EXPECT_EQ(rdm_pool_set_starts(w.pool, nullptr, 0.5), RDM_ERROR_ARGUMENT);
  record(o.r, w.pool, 30);
  EXPECT_EQ(rdm_pool_set_starts(w.pool, o.r, 1.5), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_pool_set_starts(w.pool, o.r, std::nan("")), RDM_ERROR_RANGE);
  rdm_recording_rows v = rows_of(o.r);
  std::vector<uint8_t> bytes(v.state, v.state + static_cast<size_t>(v.num_states) * info_of(o.r).state_bytes);
  bytes[bytes.size() - 9] ^= 1;
  v.state = bytes.data();
  Owned bad{recording_for(w.pool, 10)};
  ASSERT_EQ(rdm_recording_append(bad.r, &v), RDM_OK) << rdm_recording_error(bad.r);
  const uint64_t before = hash_of(w.pool);
  EXPECT_EQ(rdm_pool_set_starts(w.pool, bad.r, 0.5), RDM_ERROR_FORMAT);
  EXPECT_EQ(hash_of(w.pool), before);
  rdm_pool_config c = pool_config(4);
  rdm_pool* hands = make_pool(c);
  EXPECT_EQ(rdm_pool_set_starts(hands, o.r, 0.5), RDM_ERROR_ARGUMENT);
  rdm_pool_destroy(hands);
}

// No pool anywhere: rows of a host's own world, cloned, saved, and held near.
TEST(ContractRecording, AHostWithoutPool) {
  rdm_recording_config c;
  ASSERT_EQ(rdm_recording_config_init(&c, sizeof c), RDM_OK);
  c.obs_dim = 3, c.action_dim = 2, c.cost_dim = 1;
  CountingHost host;
  c.host = &host.hooks;
  Owned o;
  ASSERT_EQ(rdm_recording_create(&o.r, &c), RDM_OK) << rdm_last_error();
  std::vector<float> obs, action;
  for (int i = 0; i < 300; ++i) {
    for (int j = 0; j < 3; ++j) obs.push_back(std::sin(0.1f * static_cast<float>(i * (j + 1))));
    const float* x = obs.data() + 3 * i;
    action.push_back(0.5f * x[0]), action.push_back(0.3f * x[1] - 0.2f * x[2]);
  }
  rdm_recording_rows v{};
  v.struct_size = sizeof v;
  v.rows = 300, v.obs = obs.data(), v.action = action.data();
  ASSERT_EQ(rdm_recording_append(o.r, &v), RDM_OK) << rdm_recording_error(o.r);
  v.obs = nullptr;
  EXPECT_EQ(rdm_recording_append(o.r, &v), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(info_of(o.r).rows, 300);
  EXPECT_GT(host.live, 300u * 7 * 4);

  rdm_agent_config ac = agent_config();
  ac.settings = "imitation=0.5";
  rdm_agent* a = make_agent(ac);
  rdm_clone_config how;
  ASSERT_EQ(rdm_clone_config_init(&how, sizeof how), RDM_OK);
  how.epochs = 200, how.batch_rows = 32, how.patience = 0, how.learning_rate = 1e-2;
  rdm_clone_report report{};
  report.struct_size = sizeof report;
  ASSERT_EQ(rdm_agent_clone(a, o.r, &how, &report), RDM_OK) << rdm_agent_error(a);
  EXPECT_EQ(report.epochs, 200);
  EXPECT_EQ(report.validation_rows, 30);
  EXPECT_LT(report.validation_loss, 2e-3);
  float out[8];
  ASSERT_EQ(rdm_agent_act(a, obs.data(), RDM_ACT_MEAN, out), RDM_OK);
  for (int i = 0; i < 8; ++i) EXPECT_NEAR(out[i], action[static_cast<size_t>(i)], 0.15f);

  ASSERT_EQ(rdm_agent_set_recording(a, o.r), RDM_OK) << rdm_agent_error(a);
  EXPECT_EQ(feed_epoch(a), RDM_OK);
  // the rows were copied
  rdm_recording_destroy(o.r);
  o.r = nullptr;
  EXPECT_EQ(host.live, 0u);
  rdm_transition none{};
  (void)none;
  rdm_agent_destroy(a);
}

TEST(ContractRecording, ActionsAndLabelsOfAHostAreCut) {
  rdm_recording_config c;
  ASSERT_EQ(rdm_recording_config_init(&c, sizeof c), RDM_OK);
  c.obs_dim = 1, c.action_dim = 2;
  Owned o;
  ASSERT_EQ(rdm_recording_create(&o.r, &c), RDM_OK) << rdm_last_error();
  const float obs[1] = {7}, action[2] = {-3, 0.5f}, label[2] = {1e30f, -1};
  rdm_recording_rows v{};
  v.struct_size = sizeof v;
  v.rows = 1, v.obs = obs, v.action = action, v.label = label;
  ASSERT_EQ(rdm_recording_append(o.r, &v), RDM_OK) << rdm_recording_error(o.r);
  rdm_recording_rows back{};
  back.struct_size = sizeof back;
  ASSERT_EQ(rdm_recording_get_rows(o.r, &back), RDM_OK);
  EXPECT_EQ(back.obs[0], 7);
  EXPECT_EQ(back.action[0], -1);
  EXPECT_EQ(back.action[1], 0.5f);
  EXPECT_EQ(back.label[0], 1);
  EXPECT_EQ(back.label[1], -1);
}

TEST(ContractRecording, RefusedMemoryLosesNothing) {
  Worlds w;
  CountingHost host;
  Owned o{recording_for(w.pool, 4, &host.hooks)};
  record(o.r, w.pool, 3);
  const uint64_t print = info_of(o.r).fingerprint;
  for (size_t k = 0; k < 6; ++k) {
    host.refuse_at = host.calls + k;
    Owned more{recording_for(w.pool)};
    record(more.r, w.pool, 40);
    const rdm_result r = rdm_recording_append_all(o.r, more.r);
    host.refuse_at = SIZE_MAX;
    if (r == RDM_OK) break;
    EXPECT_EQ(r, RDM_ERROR_MEMORY);
    EXPECT_EQ(info_of(o.r).fingerprint, print);
    EXPECT_EQ(info_of(o.r).rows, 12);
  }
}

TEST(ContractRecording, OtherHandlesAndNull) {
  Worlds w;
  rdm_agent* a = make_agent(agent_config());
  Owned o{recording_for(w.pool)};
  auto* wrong = reinterpret_cast<rdm_recording*>(a);
  EXPECT_EQ(rdm_recording_clear(wrong), RDM_ERROR_ARGUMENT);
  EXPECT_NE(std::string(rdm_last_error()).find("agent"), std::string::npos);
  EXPECT_EQ(rdm_recording_clear(nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_agent_clone(a, nullptr, nullptr, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_agent_clone(a, o.r, nullptr, nullptr), RDM_ERROR_ARGUMENT);  // other dims
  EXPECT_EQ(rdm_agent_set_recording(a, o.r), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_agent_set_recording(a, nullptr), RDM_OK);
  EXPECT_EQ(rdm_agent_set_policy(a, nullptr, 100), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_recording_end_step(o.r, w.pool, nullptr), RDM_ERROR_STATE);
  EXPECT_EQ(rdm_recording_append_all(o.r, o.r), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_recording_filter(o.r, 2, nullptr, nullptr), RDM_ERROR_RANGE);
  const rdm_buffers b = buffers_of(w.pool);
  b.action[1] = std::nanf("");
  EXPECT_EQ(rdm_recording_begin_step(o.r, w.pool, nullptr, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(info_of(o.r).rows, 0);
  rdm_recording_destroy(nullptr);
  rdm_agent_destroy(a);
}
