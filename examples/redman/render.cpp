// `render`: a picture of a moment, a strip of moments, a film of an episode, or its playback in 3D.
#include <cstdlib>
#include <optional>

#include "commands.hpp"
#include "common/files.hpp"
#include "common/names.hpp"
#include "common/numbers.hpp"
#include "common/ownership.hpp"
#include "common/text.hpp"
#include "play/feed.hpp"
#include "play/playback.hpp"
#include "play/scene.hpp"
#include "web/glb.hpp"
#include "web/page.hpp"

namespace tool {
namespace {

constexpr int32_t kMostPixels = 8192;                     // a side
constexpr uint64_t kMostStripPixels = uint64_t{1} << 24;  // 8 moments of 1920x1080

struct RenderFlags {
  std::string policy = "hold", size = "640x480", camera = "front", out, video, html, glb, feed,
              shield = "off";
  PoolSettings pool;
  std::vector<std::string> sets;
  int32_t step = 0, strip = 0, from = 0, to = -1, width = 0, height = 0;
  bool task_given = false, step_given = false, cloud = false, plain = false;
};

void read_size(RenderFlags& flags) {
  const size_t cross = std::min(flags.size.find('x'), flags.size.size());
  uint64_t width = 0, height = 0;
  const bool read = read_whole(flags.size.substr(0, cross), &width) && cross < flags.size.size() &&
                    read_whole(flags.size.substr(cross + 1), &height);
  if (!read || width < 1 || height < 1 || width > kMostPixels || height > kMostPixels)
    throw Usage("--size " + flags.size + ": it is not WIDTHxHEIGHT, such as 640x480, up to " +
                std::to_string(kMostPixels));
  flags.width = static_cast<int32_t>(width);
  flags.height = static_cast<int32_t>(height);
  const uint64_t pixels =
      width * height * (flags.cloud ? 2 : 1) * static_cast<uint64_t>(std::max(flags.strip, 1));
  if (flags.strip > 1 && pixels > kMostStripPixels)
    throw Usage("--size " + flags.size + ", --strip " + std::to_string(flags.strip) + ": a strip of " +
                std::to_string(pixels) + " pixels, more than " + std::to_string(kMostStripPixels));
}

Scene scene_of(const RenderFlags& flags, const ActorChoice& choice) {
  return {flags.pool, choice, {flags.camera, flags.width, flags.height, flags.cloud, flags.plain}};
}

void go_to(Scene& scene, int32_t step, const char* flag) {
  scene.advance_to(step);
  if (scene.step() < step)
    throw Usage(format("%s %d: the episode ends at step %d", flag, step, scene.step()));
}

Image draw(const RenderFlags& flags, const ActorChoice& choice, Scene& scene) {
  if (flags.strip > 0) {
    Scene first = scene_of(flags, choice);
    go_to(first, flags.from, "--from");
    return draw_strip(scene, flags.strip, flags.from, last_step(std::move(first), flags.to));
  }
  go_to(scene, flags.step, "--step");
  return scene.picture();
}

void film(const RenderFlags& flags, Scene& scene) {
  const int32_t height = flags.height * (flags.cloud ? 2 : 1);
  Film film(flags.video, flags.width, height, 1 / static_cast<double>(scene.pool().spec().control_dt));
  go_to(scene, flags.from, "--from");
  do {
    film.add(scene.picture());
  } while ((flags.to < 0 || scene.step() < flags.to) && scene.advance());
  film.finish();
}

// What came of the last episode that was played: all are the same, as far as they go.
struct Played {
  Trouble trouble;
  int64_t violating_steps = 0;
  std::optional<ShieldCounts> shield;
  int32_t step = 0;

  void note(const Scene& scene) {
    step = scene.step();
    trouble = scene.trouble();
    violating_steps = scene.pool().stats().violations;
    if (scene.shielded()) shield = scene.shielded()->counts();
  }
};

Playback record(const RenderFlags& flags, const ActorChoice& choice, Played& played) {
  Scene scene = scene_of(flags, choice);
  go_to(scene, flags.from, "--from");
  Playback playback = begin_playback(scene.pool(), cost_limits(scene.pool(), choice.limits));
  playback.actor = flags.policy;
  playback.seed = flags.pool.seed;
  if (scene.shielded()) playback.shield = flags.shield;
  do {
    add_frame(playback, scene.pool());
    if (scene.shielded()) playback.stepped_in.push_back(scene.stepped_in());
  } while ((flags.to < 0 || scene.step() < flags.to) && scene.advance());
  played.note(scene);
  return playback;
}

void write_playback(const RenderFlags& flags, const Playback& playback, Json& json,
                    std::vector<std::string>& files, std::string& text) {
  if (!flags.html.empty()) {
    replace_file(flags.html, playback_page(playback, flags.camera));
    files.push_back(json["html"] = flags.html);
  }
  if (!flags.glb.empty()) {
    replace_file(flags.glb, glb_bytes(playback));
    files.push_back(json["glb"] = flags.glb);
  }
  text += format("%zu frames of playback, %zu shapes\n", playback.frames, playback.bodies.size());
}

// The episode of another program.
Report run_feed(const RenderFlags& flags) {
  if (flags.html.empty() && flags.glb.empty())
    throw Usage("--feed: say what is made of it, by --html or --glb");
  Json json;
  std::vector<std::string> files;
  std::string text;
  const Playback playback = read_episode(flags.feed);
  write_playback(flags, playback, json, files, text);
  json["file"] = files.front();
  json["frames"] = playback.frames;
  for (const std::string& file : files) text += "wrote " + file + '\n';
  return {json, text};
}

Report run_render(RenderFlags flags) {
  read_size(flags);
  if (!flags.html.empty()) check_viewer();
  check_outputs({{"--out", flags.out, ".png"},
                 {"--html", flags.html, ".html .htm"},
                 {"--glb", flags.glb, ".glb"},
                 {"--video", flags.video, ".mp4 .gif"}},
                {{"--policy", flags.policy}});
  if (!flags.feed.empty()) return run_feed(flags);
  ActorChoice choice = choose_actor(flags.policy, flags.pool.task);
  choice.shield = read_shield_word(flags.shield);
  adopt_task(choice, flags.task_given, flags.sets, flags.pool);
  apply_sets(flags.sets, flags.pool, nullptr);
  if (flags.pool.envs > 1 && (flags.cloud || !flags.html.empty() || !flags.glb.empty()))
    throw Usage("--worlds: --html, --glb and --cloud show one world");
  const bool plays = !flags.video.empty() || !flags.html.empty() || !flags.glb.empty();
  if (!plays && flags.strip == 0 && (flags.from > 0 || flags.to >= 0))
    throw Usage("--from and --to are for --strip, --video, --html and --glb; give --step for one picture");
  if (flags.to >= 0 && flags.to < flags.from)
    throw Usage(format("--to %d: it is before --from %d", flags.to, flags.from));
  const bool pictures = !plays || !flags.out.empty() || flags.strip > 0 || flags.step_given;
  if (flags.out.empty()) {
    flags.out = "render.png";
    if (pictures) check_default_output(flags.out, "\x89PNG", "--out");
  }
  Json json;
  Played played;
  int32_t frames = 0;
  double seconds = 0;
  int32_t width = flags.width, height = flags.height * (flags.cloud ? 2 : 1);
  std::vector<std::string> files;
  if (pictures) {
    Scene scene = scene_of(flags, choice);
    const Image image = draw(flags, choice, scene);
    write_png(flags.out, image);
    width = image.width;
    frames += scene.frames();
    seconds += scene.seconds();
    played.note(scene);
    files.push_back(flags.out);
  }
  if (!flags.video.empty()) {
    Scene scene = scene_of(flags, choice);
    film(flags, scene);
    frames += scene.frames();
    seconds += scene.seconds();
    played.note(scene);
    files.push_back(json["video"] = flags.video);
  }
  std::string text;
  if (frames > 0)
    text = format("%dx%d pixels, %d picture%s at %.1f per second\n", width, height, frames,
                  frames == 1 ? "" : "s", frames / std::max(seconds, 1e-9));
  if (!flags.html.empty() || !flags.glb.empty()) {
    const Playback playback = record(flags, choice, played);
    write_playback(flags, playback, json, files, text);
    if (frames == 0) json["frames"] = playback.frames;
  }
  if (flags.to > played.step && (plays || flags.strip > 0))
    std::fprintf(stderr, "--to %d: the episode ends at step %d\n", flags.to, played.step);
  json["file"] = files.front();
  put_trouble(json, played.trouble);
  say_trouble(played.trouble, "render");
  say_idle(flags.sets, flags.pool);
  if (played.shield) {
    json["violating_steps"] = played.violating_steps;
    put_shield(json, *played.shield);
    text += shield_text(*played.shield) +
            "red border: it did in the step before the picture, or since the one on its left\n";
  }
  if (frames > 0) {
    json["width"] = width;
    json["height"] = height;
    json["frames"] = frames;
    json["frames_per_second"] = frames / std::max(seconds, 1e-9);
  }
  for (const std::string& file : files) text += "wrote " + file + '\n';
  return {json, text};
}

}  // namespace

void add_render(CLI::App& app, Run& run) {
  auto flags = std::make_shared<RenderFlags>();
  CLI::App* command =
      app.add_subcommand("render", "Draw an episode: a picture, a strip, a film, or a page in 3D");
  CLI::Option* task = add_task_flag(*command, flags->pool.task, "--task",
                                    "task, by name or by its file (.task); default: the policy's task");
  command->add_option("--policy", flags->policy,
                      "policy file, run folder, .demo file, trained, plan, demo, zero, hold or random");
  command->add_option("--seed", flags->pool.seed, "seed of the episode");
  CLI::Option* step =
      command->add_option("--step", flags->step, "control step to draw; 0: the start of the episode")
          ->check(at_least(0));
  command->add_option("--strip", flags->strip, "draw this many pictures of the episode side by side")
      ->check(between(1, 64))
      ->excludes(step);
  command->add_option("--from", flags->from, "first control step of the strip, the film and the page")
      ->check(at_least(0));
  command
      ->add_option("--to", flags->to,
                   "last control step of the strip, the film and the page; default: the end of the episode")
      ->check(at_least(0));
  command->add_option("--size", flags->size, "width and height of one picture, pixels")->type_name("WxH");
  command->add_option("--camera", flags->camera, "camera of the task, by name");
  command
      ->add_option("--worlds", flags->pool.envs,
                   "number of worlds that stand side by side in a picture, each with an episode of its own")
      ->check(between(1, 1024));
  command->add_flag("--plain", flags->plain,
                    "draw as observations look, in half the time: without materials and round edges");
  command->add_flag("--cloud", flags->cloud,
                    "below each picture draw the point cloud of the last decision, by the same camera and "
                    "coloured by class");
  command->add_option("--out", flags->out, "PNG file to write; default: render.png");
  command->add_option("--video", flags->video,
                      "film of the episode to write, .mp4 or .gif; needs the program ffmpeg");
  command->add_option(
      "--html", flags->html,
      "HTML page to write: the episode in 3D, to play and rotate, above its reward and costs");
  command->add_option("--glb", flags->glb,
                      "binary glTF file to write: the episode as an animation for 3D viewers");
  CLI::Option* feed = command->add_option("--feed", flags->feed,
                                          "file of the frames of an episode that another program played, "
                                          "such as Python's package; for --html and "
                                          "--glb, instead of playing one");
  add_shield_flag(*command, flags->shield);
  add_set_flag(*command, flags->sets);
  for (const char* name : {"--task", "--policy", "--seed", "--step", "--strip", "--from", "--to", "--worlds",
                           "--video", "--cloud", "--shield", "--set"})
    feed->excludes(name);
  command->callback([&run, flags, task, step] {
    flags->task_given = task->count() > 0;
    flags->step_given = step->count() > 0;
    run = [flags] { return run_render(*flags); };
  });
}

}  // namespace tool
