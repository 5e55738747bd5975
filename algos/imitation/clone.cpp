#include "algos/imitation/clone.hpp"

#include <cmath>

#include "algos/imitation/need.hpp"
#include "base/elementary.hpp"
#include "base/error.hpp"
#include "base/shuffle.hpp"

namespace rdm {
namespace {

constexpr int32_t kFedRows = 4096;  // of a merge of statistics

void check(const ResolvedAgentConfig& resolved, const DemoRows& demo, const CloneOptions& how) {
  need("epochs", how.epochs, 1, 100000);
  need("batch_rows", how.batch_rows, 1, 1 << 20);
  need("patience", how.patience, 0, 1 << 30);
  need("learning_rate", how.learning_rate, 0, 10);
  need("learning_rate_end", how.learning_rate_end, 0, 10);
  need("validation", how.validation, 0, 0.9);
  need("capacity", how.capacity, 0, 1 << 30);
  if (how.action_std != 0) {
    need("action_std", how.action_std, resolved.shared.std_min, resolved.shared.std_max);
    if (resolved.state_std())
      fail(Code::kUnsupported,
           "action_std: with std_mode=state the network gives the deviation; set action_std to 0");
  }
  if (demo.rows < 1) fail(Code::kArgument, "recording: it has no rows");
}

// Items to learn from first, then those that are held back; returns how many the first are.
int32_t split(const DemoRows& demo, double share, Stream& stream, Vector<int32_t>& order) {
  const int32_t wanted = std::min(demo.rows - 1, static_cast<int32_t>(share * demo.rows));
  const int32_t items = demo.items();
  const int64_t episodes = demo.episodes();
  Vector<uint8_t> held(order.size(), 0);
  int32_t count = 0;  // rows that are held back
  if (episodes < 2) {
    for (int32_t i = 0; i < items; ++i) order[static_cast<size_t>(i)] = i;
    shuffle(stream, order.data(), items);
    for (int32_t i = 0; i < items && count < wanted; ++i) {
      const int32_t item = order[static_cast<size_t>(i)];
      if (count + demo.rows_of(item) >= demo.rows) continue;
      held[static_cast<size_t>(item)] = 1, count += demo.rows_of(item);
    }
  } else {
    Vector<int32_t> length(static_cast<size_t>(episodes)), drawn(static_cast<size_t>(episodes));
    Vector<uint8_t> chosen(static_cast<size_t>(episodes), 0);
    for (int32_t i = 0; i < demo.rows; ++i) ++length[static_cast<size_t>(demo.episode[i])];
    for (size_t e = 0; e < drawn.size(); ++e) drawn[e] = static_cast<int32_t>(e);
    shuffle(stream, drawn.data(), static_cast<int32_t>(episodes));
    for (size_t k = 0; k < drawn.size() && count < wanted; ++k) {
      const auto e = static_cast<size_t>(drawn[k]);
      if (count + length[e] >= demo.rows) continue;
      chosen[e] = 1, count += length[e];
    }
    for (int32_t i = 0; i < items; ++i)
      held[static_cast<size_t>(i)] = chosen[static_cast<size_t>(demo.episode_of(demo.first_row(i)))];
  }
  int32_t learned = 0;
  const auto train = static_cast<int32_t>(std::count(held.begin(), held.end(), uint8_t{0}));
  int32_t last = train;
  for (int32_t i = 0; i < items; ++i)
    order[static_cast<size_t>(held[static_cast<size_t>(i)] ? last++ : learned++)] = i;
  return train;
}

// How many of `left` listed items make a minibatch of so many rows, or the first that is longer.
int32_t minibatch(const DemoRows& demo, const int32_t* order, int32_t left, int32_t batch_rows) {
  int32_t items = 0;
  for (int32_t rows = 0; items < left && rows < batch_rows; ++items) rows += demo.rows_of(order[items]);
  return items;
}

int32_t rows_of(const DemoRows& demo, const int32_t* order, int32_t items) {
  int32_t rows = 0;
  for (int32_t i = 0; i < items; ++i) rows += demo.rows_of(order[i]);
  return rows;
}

void feed(Normalizer& n, const DemoRows& demo, double count_max) {
  normalizer_reset(n);
  for (int32_t first = 0; first < demo.rows; first += kFedRows)
    normalizer_merge(n, demo.obs + static_cast<size_t>(first) * static_cast<size_t>(n.dim),
                     std::min(kFedRows, demo.rows - first), nullptr, count_max);
}

// What a failure puts back.
struct Backup {
  Backup(const Networks& nets, const Normalizer& n)
      : params(nets.params, nets.params + nets.block[Networks::kActor].size),
        mean(n.mean, n.mean + n.dim),
        m2(n.m2, n.m2 + n.dim),
        count(n.count) {}
  void restore(Networks& nets, Normalizer& n) const {
    std::copy(params.begin(), params.end(), nets.params);
    std::copy(mean.begin(), mean.end(), n.mean);
    std::copy(m2.begin(), m2.end(), n.m2);
    n.count = count;
    normalizer_refresh(n);
  }
  Vector<float> params;
  Vector<double> mean, m2;
  double count;
};

}  // namespace

CloneReport clone_actor(const ResolvedAgentConfig& resolved, const DemoRows& given, const CloneOptions& how,
                        const Regression& regression, Networks& nets, Normalizer& normalizer,
                        CancelFlag& cancel) {
  check(resolved, given, how);
  // Of an encoder that stands still the features are computed once.
  DemoRows demo = given;
  Vector<float> features(
      resolved.frozen ? static_cast<size_t>(demo.rows) * static_cast<size_t>(resolved.eyes.features()) : 0);
  if (resolved.frozen) {
    regression.features(demo, features.data());
    demo.clouds.features = features.data();
  }
  Block& actor = nets.block[Networks::kActor];
  const Backup before(nets, normalizer);
  Vector<int32_t> order(static_cast<size_t>(demo.items()));
  Vector<float> best(nets.params, nets.params + actor.size), grad(nets.size), m(actor.size), v(actor.size);
  Adam adam;
  adam.size = actor.size, adam.m = m.data(), adam.v = v.data();
  Stream stream(how.seed, 0, Purpose::kClone);
  const double dim = static_cast<double>(resolved.action_dim());
  CloneReport out;
  try {
    const int32_t learned = split(demo, how.validation, stream, order);
    const int32_t* const held_back = order.data() + learned;
    out.train_rows = rows_of(demo, order.data(), learned);
    out.validation_rows = demo.rows - out.train_rows;
    if (how.feed_normalizer) feed(normalizer, demo, resolved.shared.obs_count_max);
    regression.remember(demo);
    for (int32_t e = 0; e < how.epochs; ++e) {
      const double done = how.epochs > 1 ? static_cast<double>(e) / (how.epochs - 1) : 0;
      const double rate = how.learning_rate + done * (how.learning_rate_end - how.learning_rate);
      shuffle(stream, order.data(), learned);
      double sum = 0;
      for (int32_t first = 0, items = 0; first < learned; first += items) {
        cancel.check();
        const int32_t* const listed = order.data() + first;
        items = minibatch(demo, listed, learned - first, how.batch_rows);
        // the mean over entries of squared errors is 2 / dim of the regression's
        sum += rows_of(demo, listed, items) *
               regression.gradient(demo, listed, items, false, 2 / dim, grad.data());
        adam_step(adam, nets.params, grad.data(), rate, 0);
      }
      regression.remember(demo);  // also for the next epoch
      const double train = 2 / dim * sum / out.train_rows;
      const double held = out.validation_rows > 0
                              ? 2 / dim * regression.loss(demo, held_back, demo.items() - learned, false)
                              : kNothing;
      if (how.train_loss && e < how.capacity) how.train_loss[e] = train;
      if (how.validation_loss && e < how.capacity) how.validation_loss[e] = held;
      out.epochs = e + 1;
      if (out.validation_rows == 0 || out.best_epoch == 0 || held < out.validation_loss) {
        out.best_epoch = e + 1;
        out.train_loss = train, out.validation_loss = held;
        std::copy_n(nets.params, actor.size, best.begin());
      }
      out.stopped = how.patience > 0 && out.validation_rows > 0 && e + 1 - out.best_epoch >= how.patience &&
                    e + 1 < how.epochs;
      if (out.stopped) break;
    }
    if (!std::isfinite(out.train_loss))
      fail(Code::kArgument, "learning_rate: the actor's weights overflowed");
  } catch (...) {
    before.restore(nets, normalizer);
    throw;
  }
  std::copy(best.begin(), best.end(), nets.params);
  for (int32_t j = 0; how.action_std > 0 && j < nets.action_dim; ++j)
    nets.log_std()[j] = static_cast<float>(elementary::log(how.action_std));
  clamp_log_std(nets);
  std::fill_n(actor.adam.m, actor.size, 0.0f);
  std::fill_n(actor.adam.v, actor.size, 0.0f);
  restart_steps(nets);
  return out;
}

}  // namespace rdm
