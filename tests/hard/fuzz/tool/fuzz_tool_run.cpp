// What a run folder holds beside policies and checkpoints: config.json, as a run's settings and as a plot's
// labels, the trainer's note in a checkpoint, progress.csv.
#include "../fuzz.hpp"
#include "common/report.hpp"
#include "run/config.hpp"
#include "run/events.hpp"
#include "run/note.hpp"
#include "run/progress.hpp"

namespace hard {

std::vector<Bytes> seeds() {
  tool::Note note;
  note.epoch = 3;
  note.env_steps = 4096;
  note.progress_bytes = 100;
  note.seconds = 1.5;
  std::vector<Bytes> out;
  const std::string plain = tool::note_bytes(note);
  note.last = tool::LastEvaluation{1.5, 2};
  note.best = tool::Score{true, 1.5, 0};
  const unsigned char some[4] = {1, 2, 3, 4};
  note.best_policy.assign(some, some + 4);
  const std::string full = tool::note_bytes(note);
  note.shield.assign(some, some + 3);
  const std::string shielded = tool::note_bytes(note);
  redman::Pool pool(redman::pool_config("two_state"));
  redman::Agent agent(redman::agent_config(pool));
  const std::string config = tool::config_text(tool::RunSettings{}, pool, agent, {2.5}, 1024);
  out.push_back(with_pick(0, bytes_of(config)));
  out.push_back(with_pick(1, bytes_of(config)));
  out.push_back(with_pick(2, bytes_of(plain)));
  out.push_back(with_pick(2, bytes_of(full)));
  out.push_back(with_pick(2, bytes_of(shielded)));
  out.push_back(with_pick(3, bytes_of("TotalEnvSteps,Metrics/EpRet,Metrics/EpCost\n1,2,3\n4,nan,6\n7,8\n")));
  return out;
}
void whole(unsigned char*, size_t) {}
size_t fixed_bytes() {
  return 1;
}

void one(const unsigned char* data, size_t size) {
  if (size == 0) return;
  const char* text = reinterpret_cast<const char*>(data + 1);
  try {
    switch (pick(data, size, 4)) {
      case 0: {
        const tool::RunSettings s = tool::parse_config(text, size - 1);
        HARD_REQUIRE(s.steps > 0 && s.eval_every > 0 && s.checkpoint_every > 0 && s.pool.envs > 0,
                     "a count is not positive");
        break;
      }
      case 1: {
        const tool::RunLabel l = tool::parse_label(text, size - 1);
        HARD_REQUIRE(tool::parse_flat_config(text, size - 1).at("task") == l.task, "another task");
        break;
      }
      case 2: {
        const tool::Note n = tool::parse_note(text, size - 1);
        HARD_REQUIRE(n.epoch >= 0 && n.env_steps >= 0 && std::isfinite(n.seconds),
                     "a number is out of its bounds");
        HARD_REQUIRE(n.best || n.best_policy.empty(), "a best policy without its score");
        break;
      }
      default: {
        size_t rows = SIZE_MAX;
        for (const auto& [name, column] : tool::parse_progress(text, size - 1)) {
          HARD_REQUIRE(rows == SIZE_MAX || rows == column.size(), "columns of different lengths");
          rows = column.size();
        }
        const std::string events = tool::event_bytes(std::string(text, size - 1), 0);
        HARD_REQUIRE(events.rfind(tool::event_head(0), 0) == 0, "no head");
      }
    }
  } catch (const tool::Failure& e) {
    HARD_REQUIRE(*e.what(), "no text");
  } catch (const tool::Usage& e) {
    HARD_REQUIRE(*e.what(), "no text");
  }
}

}  // namespace hard
