#include "run/folder.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <utility>

#include "common/files.hpp"
#include "common/json.hpp"
#include "common/names.hpp"
#include "common/ownership.hpp"
#include "common/posix.hpp"
#include "common/text.hpp"
#include "run/events.hpp"

namespace tool {
namespace {

namespace fs = std::filesystem;

std::string canonical_task(const std::string& name) {
  return task_at(find_task(name)).name;
}
std::string canonical_algo(const std::string& name) {
  return algo_at(find_algo(name)).name;
}

constexpr int kMostTwins = 1000;  // run folders of one second

// A dangling link stands in the way of a folder, and the system blames its name alone.
void make_folders(const std::string& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (!error && is_folder(path)) return;
  for (fs::path at = path; !at.empty() && at != at.parent_path(); at = at.parent_path()) {
    std::error_code unread;
    if (!fs::is_symlink(fs::symlink_status(at, unread)) || fs::exists(at, unread)) continue;
    throw Failure("cannot make folder " + path + ": " + at.string() + " is a link to " +
                  fs::read_symlink(at, unread).string() + ", which does not exist");
  }
  throw Failure("cannot make folder " + path + ": " +
                (error ? error.message() : "something else has this name"));
}

int locked(const std::string& path) {
  const int folder = lock_folder(path);
  if (folder >= 0) return folder;
  if (errno != EWOULDBLOCK) throw Failure("cannot open folder " + path + ": " + std::strerror(errno));
  throw Failure("another process is training in " + path + ": wait for it or stop it, or give another --out");
}

// A file that grows, for writing; -1, and errno says why.
int open_growing(const std::string& path, struct stat* s) {
  const int f = ::open(path.c_str(), O_WRONLY | O_APPEND | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (f < 0) return f;
  if (fstat(f, s) == 0 && S_ISREG(s->st_mode)) return f;
  close(f);
  errno = EINVAL;
  return -1;
}

// All of it or nothing. Returns the new length.
size_t append_whole(const std::string& path, const std::string& bytes) {
  struct stat s {};
  const int f = open_growing(path, &s);
  size_t wrote = 0;
  while (f >= 0 && wrote < bytes.size()) {  // where a part fits, the rest says why no more does
    const ssize_t part = ::write(f, bytes.data() + wrote, bytes.size() - wrote);
    if (part <= 0) break;
    wrote += static_cast<size_t>(part);
  }
  const int error = errno;
  const bool good = f >= 0 && wrote == bytes.size();
  const bool cut = good || f < 0 || ftruncate(f, s.st_size) == 0;  // a part of a row is none
  if (f >= 0) close(f);
  if (!good || !cut) throw Failure("cannot write " + path + ": " + std::strerror(error));
  return static_cast<size_t>(s.st_size) + bytes.size();
}

// Of redman's, or what a killed writer of one has left.
bool is_own_event_file(const std::string& folder, const std::string& name) {
  const std::string whole = name.substr(0, name.find(kTemporary)), path = folder + '/' + name;
  if (whole != name && !is_temporary(name, whole)) return false;
  const size_t digits = std::min(whole.find_first_of("0123456789"), whole.size());
  const int64_t unix_seconds = std::strtoll(whole.c_str() + digits, nullptr, 10);
  std::error_code error;
  if (whole != event_file_name(unix_seconds) || !fs::is_regular_file(fs::symlink_status(path, error)))
    return false;
  const std::string head = event_head(unix_seconds), bytes = beginning_of(path, head.size());
  return head.compare(0, bytes.size(), bytes) == 0;  // a kill leaves a part of it, or nothing
}

}  // namespace

void RunFolder::check_place(const std::string& path) {
  fs::path at = fs::path(path) / "";  // the last folder above that is there, and "" where one begins
  std::error_code error;
  do at = at.parent_path();
  while (!at.empty() && at != at.parent_path() && !fs::exists(fs::symlink_status(at, error)));
  if (!at.empty() && !fs::is_directory(at, error)) make_folders(path);  // which says why not
  try {
    PreparedFile((at / ".redman-run").string());  // goes again
  } catch (const Failure& e) {
    throw Failure("cannot make folder " + path + ": " + e.what());
  }
}

void RunFolder::check_new(const std::string& path, bool overwrite) {
  check_place(path);
  if (!is_folder(path)) return;
  const RunFolder held(path, locked(path));  // another process may train there
  check_free(path, overwrite);
}

RunFolder RunFolder::create(const std::string& path, bool overwrite) {
  make_folders(path);
  RunFolder folder(path, locked(path));
  check_free(path, overwrite);
  return folder;
}

void RunFolder::check_free(const std::string& path, bool overwrite) {
  check_run_files(path);
  const std::string there = first_run_file(path);
  if (overwrite || there.empty()) return;
  if (there != "config.json")
    throw Failure(path + " holds " + there +
                  " of another run: replace it with --overwrite, or give another --out");
  throw Failure(path + " holds a run already: continue it with --resume " + path +
                ", begin again with --overwrite, or give another --out");
}

RunFolder RunFolder::create_default(const RunSettings& settings) {
  const std::string first = default_path(settings);
  make_folders(fs::path(first).parent_path().string());
  for (int i = 1; i <= kMostTwins; ++i) {  // two that begin in one second: one makes the folder
    const std::string path = i == 1 ? first : first + "-" + std::to_string(i);
    std::error_code error;
    if (fs::create_directory(path, error)) return RunFolder(path, locked(path));
    if (error && !fs::exists(fs::symlink_status(path)))
      throw Failure("cannot make folder " + path + ": " + error.message());
  }
  throw Failure("cannot make folder " + first + ": " + std::to_string(kMostTwins) +
                " folders of its name exist");
}

RunFolder RunFolder::go_on(const std::string& path) {
  if (std::error_code error; fs::exists(path, error) && !is_folder(path))
    throw Failure(path + " is not a run folder: it is no folder");
  if (!file_exists(path + "/config.json"))
    throw Failure(
        path + " is not a run folder: " +
        (is_folder(path) ? "it has no config.json" : "it does not exist" + missing_file_hint(path)) +
        "; start one with train --out " + path);
  RunFolder folder(path, locked(path));
  folder.goes_on_ = true;
  check_run_files(path);
  for (const std::string& file : {folder.config(), folder.progress(), folder.policy(), folder.checkpoint()})
    sweep_temporaries(file, true);
  return folder;
}

RunFolder::RunFolder(RunFolder&& other) noexcept
    : path_(std::move(other.path_)),
      header_(std::move(other.header_)),
      events_(std::move(other.events_)),
      begun_(other.begun_),
      goes_on_(other.goes_on_),
      lock_(std::exchange(other.lock_, -1)) {}

RunFolder::~RunFolder() {
  if (lock_ >= 0) close(lock_);
}

std::string RunFolder::default_path(const RunSettings& settings) {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
#if defined(_WIN32)
  localtime_s(&local, &now);
#else
  localtime_r(&now, &local);
#endif
  char stamp[32];
  std::strftime(stamp, sizeof stamp, "%Y-%m-%d-%H-%M-%S", &local);
  return format("runs/%s-{%s}/seed-%03llu-%s", canonical_algo(settings.agent.algo).c_str(),
                canonical_task(settings.pool.task).c_str(),
                static_cast<unsigned long long>(settings.pool.seed), stamp);
}

void RunFolder::start(const std::string& config, const std::string& header, const std::string& policy,
                      bool with_events) {
  for (const std::string& file : {this->config(), progress(), this->policy(), checkpoint()})
    sweep_temporaries(file, true);
  PreparedFile new_config(this->config(), config), new_progress(progress(), header + '\n'),
      new_policy(this->policy(), policy);
  // the checkpoint first: a kill in between must not leave it beside another run's files
  if (unlink(checkpoint().c_str()) != 0 && errno != ENOENT)
    throw Failure("cannot remove " + checkpoint() + ": " + std::strerror(errno));
  // the event file of a run that goes on is written anew in its place: a reader may be following it
  if (!goes_on_)
    for (const std::string& name : event_files()) unlink(file(name.c_str()).c_str());
  new_config.commit();
  new_progress.commit();
  new_policy.commit();
  header_ = header;
  if (with_events) write_events(header + '\n');
}

void RunFolder::write_config(const std::string& text) const {
  check();
  PreparedFile(config(), text).commit();
}

void RunFolder::write_policy(const std::string& bytes) const {
  check();
  PreparedFile(policy(), bytes).commit();
}

size_t RunFolder::append_progress(const std::string& row) const {
  check();
  const size_t size = append_whole(progress(), row + '\n');
  if (!events_.empty()) append_whole(file(events_.c_str()), event_row(header_, row, begun_));
  return size;
}

void RunFolder::cut_progress(size_t bytes, bool with_events) {
  struct stat s {};
  const int f = open_growing(progress(), &s);
  const bool opened = f >= 0, enough = opened && static_cast<size_t>(s.st_size) >= bytes;
  const bool good = enough && ftruncate(f, static_cast<off_t>(bytes)) == 0;
  const int error = errno;
  if (opened) close(f);
  if (opened && !enough)
    throw Failure(progress() + " is shorter than the checkpoint says; start the run again");
  if (!good) throw Failure("cannot shorten " + progress() + ": " + std::strerror(error));
  const std::string kept = read_file(progress());
  header_ = kept.substr(0, kept.find('\n'));
  if (with_events) write_events(kept);
}

std::vector<std::string> RunFolder::event_files() const {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator at(path_, error); !error && at != fs::directory_iterator(); at.increment(error))
    if (is_own_event_file(path_, at->path().filename().string()))
      names.push_back(at->path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

// Into the file that is there, which a reader may be following; else into a new one.
void RunFolder::write_events(const std::string& progress) {
  begun_ = std::time(nullptr);
  events_ = event_file_name(begun_);
  for (const std::string& name : event_files()) {
    if (name.find(".tmp-") != std::string::npos) unlink(file(name.c_str()).c_str());  // of a killed writer
    const int64_t said = std::strtoll(name.c_str() + name.find("tfevents.") + 9, nullptr, 10);
    if (name != event_file_name(said)) continue;
    begun_ = said;
    events_ = name;
  }
  const std::string path = file(events_.c_str()), bytes = event_bytes(progress, begun_);
  if (!fs::exists(fs::symlink_status(path))) return PreparedFile(path, bytes).commit();
  if (!is_own_event_file(path_, events_))
    throw Failure(path + " was not written by redman: move it away, or give another folder");
  struct stat s {};
  const int f = open_growing(path, &s);
  const bool emptied = f >= 0 && ftruncate(f, 0) == 0;
  const int error = errno;
  if (f >= 0) close(f);
  if (!emptied) throw Failure("cannot write " + path + ": " + std::strerror(error));
  append_whole(path, bytes);
}

void RunFolder::check() const {
  if (!is_same_folder(lock_, path_))
    throw Failure("the run folder " + path_ + " was removed while this run was training in it");
}

RunSettings run_settings(const std::string& folder) {
  const std::string path = folder + "/config.json", text = read_file(path, kMostJsonBytes);
  RunSettings run;
  try {
    run = parse_config(text.data(), text.size());
  } catch (const Failure& e) {
    throw Failure(path + " is not a run's configuration: " + e.what());
  }
  int32_t known = -1;
  if (!run.task_class.empty() && rdm_task_find(run.pool.task.c_str(), &known) != RDM_OK)
    throw Failure(folder + ": its task " + run.pool.task + " is a class in Python, " + run.task_class +
                  ": use redman.evaluate and redman.train(resume=...) there");
  load_own_files(run.pool.task, run.own, path);
  return run;
}

std::string run_folder_of(const std::string& file) {
  const std::string folder = is_folder(file) ? file : fs::path(file).parent_path().string();
  const std::string path = folder.empty() ? "." : folder;
  return file_exists(path + "/config.json") ? path : "";
}

}  // namespace tool
