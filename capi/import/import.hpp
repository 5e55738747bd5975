// What the readers of redman_import share: refusals, the robot under construction, and its notes.
#pragma once
#include <redman/import.h>

#include <array>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "budget.hpp"

namespace rdm::import {

// A file that cannot be a robot. The text is one line and names the line of the file and the element.
struct Refusal {
  rdm_result code;
  std::string text;
};
[[noreturn]] [[gnu::format(printf, 2, 3)]] void refuse(rdm_result code, const char* format, ...);
[[gnu::format(printf, 1, 2)]] std::string format(const char* pattern, ...);

// One line of valid UTF-8: control characters become spaces, other bytes \xNN; cut after `most` bytes.
std::string clean(const std::string& text, size_t most = 64);
// "; nearest is NAME", or "" when none is near.
std::string nearest_hint(const std::string& word, const std::vector<std::string>& names);
// Of the keys of a map.
template <class Map>
std::string nearest_key(const std::string& word, const Map& known) {
  std::vector<std::string> names;
  names.reserve(known.size());
  for (const auto& [name, row] : known) names.push_back(name);
  return nearest_hint(word, names);
}
// Case is ignored and '-' equals '_', as redman compares names.
bool same_name(const std::string& a, const std::string& b);

inline constexpr size_t kMostNotes = 4096;
// NOT_FOUND, IO for what is no regular file, none of which is waited for; RANGE above `longest` bytes.
std::string read_file(const std::string& path, size_t longest);
bool file_exists(const std::string& path);
std::string folder_of(const std::string& path);  // with its last '/', "" for a plain name

struct Note {
  int32_t kind, line;
  std::string text;
};

// Owns what an rdm_robot_def points to. Rows name their texts by `keep`.
struct Draft {
  std::deque<std::string> texts;
  std::vector<rdm_robot_link> links;
  std::vector<rdm_robot_shape> shapes;
  std::vector<rdm_robot_pair> pairs;
  std::vector<rdm_robot_coupling> couplings;
  std::vector<rdm_robot_curve> curves;
  std::vector<int32_t> commands;
  std::vector<rdm_robot_finger> fingers;
  std::vector<double> home, folded;
  std::vector<float> closed;
  bool all_pairs = false;  // all but neighbours, whatever `pairs` holds
  bool passive = false;    // nothing is commanded
  rdm_robot_def def{};     // its scalars; arrays and counts by bind()

  std::vector<Note> notes;
  Budget budget;  // of the files that it comes from

  Draft();
  Draft(const Draft&) = delete;
  Draft& operator=(const Draft&) = delete;
  const char* keep(std::string text);
  void bind();
  [[gnu::format(printf, 4, 5)]] void note(int32_t kind, int32_t line, const char* pattern, ...);
};

// The same of an rdm_object_def.
struct ObjectDraft {
  std::deque<std::string> texts;
  std::deque<std::vector<double>> points;
  std::vector<rdm_shape_def> shapes;
  rdm_object_def def{};

  ObjectDraft();
  ObjectDraft(const ObjectDraft&) = delete;
  ObjectDraft& operator=(const ObjectDraft&) = delete;
  const char* keep(std::string text);
  void bind();
};
void read_object(const std::string& bytes, ObjectDraft* out);
// An object that is there.
void read_built_object(int32_t object, ObjectDraft* out);
std::string write_object(const rdm_object_def& def);

// Options with every text in a string; what is NULL is not `given`.
struct Options {
  int32_t format = RDM_IMPORT_AUTO, kind = -1;
  bool skip_meshes = false, mend_inertia = false;
  double density = 0, slide_range = 0;
  std::string name, folder, packages, root, palm, tips, mount, flange;
  bool has_folder = false;
  std::string file;  // as it is named in texts
};

void read_urdf(const std::string& bytes, const Options& options, Draft* out);
void read_mjcf(const std::string& bytes, const Options& options, Draft* out);
void read_robot(const std::string& bytes, const Options& options, Draft* out);
std::string write_robot(const rdm_robot_def& def);
// A robot that is there, with all its rows.
void read_built(int32_t robot, Draft* out);
// Registers the task that the bytes describe; its number. `file` is how texts name it.
int32_t read_task(const std::string& bytes, const std::string& file);
// Whether the bytes begin with an element, and which: "robot", "mujoco"; "" for what is no XML.
std::string first_element(const std::string& bytes);

// Adds what was found to the notes; `draft` is bound and was taken by rdm_robot_create.
void check_robot(Draft* draft);

}  // namespace rdm::import
