// `view`: a page on running worlds, to look at them, to stop and go back, to push, and to act by hand.
#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <memory>

#include "commands.hpp"
#include "common/clock.hpp"
#include "common/files.hpp"
#include "common/names.hpp"
#include "common/numbers.hpp"
#include "common/posix.hpp"
#include "common/text.hpp"
#include "play/shield_word.hpp"
#include "view/fed.hpp"
#include "view/server.hpp"
#include "view/session.hpp"
#include "web/page.hpp"

namespace tool {
namespace {

constexpr double kFrameSeconds = 1.0 / 30;
constexpr int32_t kMostViewed = 64;  // worlds
constexpr int kMostUnseen = 2;       // frames

std::atomic<bool> g_ends{false};

extern "C" void on_end(int) {
  g_ends = true;
}

class EndScope {
 public:
  EndScope() : old_int_(std::signal(SIGINT, on_end)), old_term_(std::signal(SIGTERM, on_end)) {
    g_ends = false;
  }
  ~EndScope() {
    std::signal(SIGINT, old_int_);
    std::signal(SIGTERM, old_term_);
  }
  EndScope(const EndScope&) = delete;
  EndScope& operator=(const EndScope&) = delete;

 private:
  using Handler = void (*)(int);
  Handler old_int_, old_term_;
};

struct ViewFlags {
  ViewSettings view;
  std::vector<std::string> sets;
  int32_t port = 0;
  double megabytes = 64;
  bool opens = false, paused = false, feed = false, task_given = false, record_given = false;
};

// The loop between worlds, which go by the clock, and windows.
class View {
 public:
  View(Viewed& session, ViewServer& server, bool paused)
      : session_(session), server_(server), paused_(paused) {}
  void run() {
    for (auto before = Clock::now(); !g_ends;) {
      hear(server_.wait(pause()));
      const auto now = Clock::now();
      go_on(std::chrono::duration<double>(now - before).count());
      before = now;
      if (!session_.listen(windows_.size())) return;
      show();
    }
  }
  int64_t frames() const { return frames_; }
  double seconds() const { return seconds_; }

 private:
  struct Window {
    int number;
    int64_t scene = 0, change = 0;  // that it has
    int64_t moment = -1;            // that it saw last
    int32_t watched = 0;            // of which world it has rows
    int unseen = 0;                 // frames that it has not drawn yet
  };

  // A frame that is overdue waits for its window, or for a change.
  double pause() const {
    const double most = session_.patience();
    if (windows_.empty()) return most;
    const double frame = -since(due_), step = session_.plays() ? (1 - owed_) * session_.step_seconds() : most;
    return std::max(0.0, std::min(most, frame > 0 ? std::min(frame, step) : step));
  }
  void hear(const std::vector<ViewServer::Event>& events) {
    for (const auto& e : events) {
      if (e.kind == ViewServer::Event::kOpened) {
        windows_.push_back({e.window});
        if (!paused_ && !begun_ && session_.scene_number() > 0)
          session_.command({{"do", "play"}, {"on", true}});
        begun_ = true;
      } else if (e.kind == ViewServer::Event::kClosed) {
        windows_.erase(std::remove_if(windows_.begin(), windows_.end(),
                                      [&](const Window& w) { return w.number == e.window; }),
                       windows_.end());
        if (session_.scene_number() > 0) session_.command({{"do", "release"}});
      } else {
        answer(e);
      }
    }
  }
  void answer(const ViewServer::Event& e) {
    Json said = {{"say", "answer"}};
    try {
      const Document asked = parse_json(e.text.data(), e.text.size());
      if (text_at(asked, "do", 16) == "shown") {
        for (Window& w : windows_) w.unseen = w.number == e.window ? 0 : w.unseen;
        return;
      }
      if (asked.contains("id")) said["id"] = integer_at(asked, "id", 0, kMostExact);
      said.update(session_.command(asked));
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& error) {
      said["error"] = printable(error.what());
    }
    if (said.size() > 1) server_.send_text(e.window, json_text(said));
  }
  // Worlds stand while nobody looks, and do not catch up on what was too much.
  void go_on(double seconds) {
    if (windows_.empty() || !session_.plays()) {
      owed_ = 0;
      return;
    }
    seconds_ += seconds;
    owed_ = std::min(owed_ + seconds / session_.step_seconds(), std::max(1.0, 0.1 / session_.step_seconds()));
    const auto begin = Clock::now();
    try {
      for (; owed_ >= 1 && session_.plays() && since(begin) < kFrameSeconds / 2; --owed_) session_.step();
    } catch (const std::exception& error) {
      session_.pause();
      for (const Window& w : windows_)
        server_.send_text(w.number, json_text({{"say", "answer"}, {"error", printable(error.what())}}));
    }
  }
  void show() {
    const auto now = Clock::now();
    if (now < due_) return;
    bool shown = false;
    for (Window& w : windows_) {
      if (!server_.ready(w.number) || session_.scene_number() == 0) continue;
      if (w.scene != session_.scene_number()) {
        server_.send_text(w.number, json_text(session_.scene()));
        w.scene = session_.scene_number();
        w.change = w.moment = -1;
      }
      if (w.change == session_.changes() || w.unseen >= kMostUnseen) continue;
      if (w.watched != session_.watched_world()) w.moment = -1;
      w.watched = session_.watched_world();
      server_.send_bytes(w.number, session_.frame(w.moment));
      w.moment = session_.at();
      shown = true;
      w.change = session_.changes();
      ++w.unseen;
    }
    if (!shown) return;
    frames_ += session_.plays();
    const auto every =
        std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(kFrameSeconds));
    due_ = std::max(due_ + every, now);  // what came late by less than one is made up for
  }

  Viewed& session_;
  ViewServer& server_;
  bool paused_, begun_ = false;
  std::vector<Window> windows_;
  double owed_ = 0, seconds_ = 0;  // steps; s of playing
  int64_t frames_ = 0;
  Clock::time_point due_ = Clock::now();  // the next frame
};

size_t history_bytes(const ViewFlags& flags) {
  return static_cast<size_t>(flags.megabytes * (1 << 20));
}

Report serve(const ViewFlags& flags, Viewed& viewed, const std::string& title) {
  ViewServer server(static_cast<uint16_t>(flags.port),
                    filled_page("view.html", {{"title", html_text(title)}}));
  EndScope scope;
  std::fprintf(stderr, "%s\nCtrl-C ends it\n", server.address().c_str());
  if (flags.feed) {
    std::printf("%s\n", json_text({{"address", server.address()}}).c_str());
    std::fflush(stdout);
  }
  if (flags.opens && !open_browser(server.address().c_str()))
    std::fprintf(stderr, "--open: no browser was found; open the address yourself\n");
  View view(viewed, server, flags.paused);
  view.run();
  viewed.finish();
  Json json = viewed.summary();
  json["frames"] = view.frames();
  json["seconds"] = view.seconds();
  json["frames_per_second"] =
      view.seconds() > 0 ? Json(static_cast<double>(view.frames()) / view.seconds()) : Json();
  std::string text =
      format("%lld steps, %lld frames in %.1f s of playing", static_cast<long long>(viewed.steps()),
             static_cast<long long>(view.frames()), view.seconds());
  if (view.seconds() > 0)
    text += format(", %.1f a second", static_cast<double>(view.frames()) / view.seconds());
  text += '\n';
  for (const std::string file : json["files"]) text += "wrote " + file + '\n';
  return {json, text};
}

Report run_view(ViewFlags flags) {
  ViewSettings& v = flags.view;
  check_viewer();
  check_replaceable(v.record);
  if (flags.record_given) check_outputs({{"--record", v.record, kRecordEndings}});
  if (v.policies.empty()) v.policies = {"hold"};
  ActorChoice choice = choose_actor(v.policies.front(), v.pool.task);
  adopt_task(choice, flags.task_given, flags.sets, v.pool);
  need_one_limit_each(v.pool.task, v.limits);
  apply_sets(flags.sets, v.pool, nullptr);
  v.history_bytes = history_bytes(flags);
  Session session(v);
  say_idle(flags.sets, v.pool);
  return serve(flags, session, v.pool.task);
}

// Worlds of another program, until it has nothing more to say.
Report run_fed(const ViewFlags& flags) {
  check_viewer();
  const auto say = [](const std::string& line) {
    std::fputs((line + '\n').c_str(), stdout);
    std::fflush(stdout);
  };
#if defined(_WIN32)
  _setmode(STDIN_FILENO, _O_BINARY);
#endif
  Fed fed(STDIN_FILENO, say, history_bytes(flags), !flags.paused);
  return serve(flags, fed, "redman");
}

}  // namespace

void add_view(CLI::App& app, Run& run) {
  auto flags = std::make_shared<ViewFlags>();
  CLI::App* command = app.add_subcommand(
      "view", "Show running worlds on a web page: look around, pause, go back, push, act by hand, record");
  CLI::Option* task =
      add_pool_flags(*command, flags->view.pool, "task, or its file (.task); default: the policy's");
  command
      ->add_option("--policy", flags->view.policies,
                   "what acts: policy file, run folder, .demo file, recorded .npz file, trained, plan, demo, "
                   "zero, hold or random; repeat it to offer more choices on the page")
      ->allow_extra_args(false);
  command->add_option("--port", flags->port, "port on 127.0.0.1; 0: any free one")->check(between(0, 65535));
  command->add_flag("--open", flags->opens, "open the page in a browser");
  command->add_flag("--paused", flags->paused, "start paused");
  CLI::Option* feed = command->add_flag(
      "--feed", flags->feed,
      "show the worlds of another program, such as Python's package, which sends them to standard input");
  command->add_option("--history", flags->megabytes, "memory for past states to go back to, MB")
      ->check(between(0.0, 65536.0));
  CLI::Option* record = command->add_option("--record", flags->view.record,
                                            "file that the page's record button writes (.npz or .csv)");
  add_shield_flag(*command, flags->view.shield);
  add_cost_limit_flag(*command, flags->view.limits);
  add_set_flag(*command, flags->sets);
  for (const char* name : {"--task", "--policy", "--envs", "--record", "--shield", "--cost-limit", "--set"})
    feed->excludes(name);
  command->callback([&run, flags, task, record] {
    flags->task_given = task->count() > 0;
    flags->record_given = record->count() > 0;
    if (flags->view.pool.envs > kMostViewed)
      throw Usage(format("--envs: the page shows at most %d worlds", kMostViewed));
    run = [flags] { return flags->feed ? run_fed(*flags) : run_view(*flags); };
  });
}

}  // namespace tool
