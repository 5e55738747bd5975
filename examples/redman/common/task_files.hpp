// Tasks, robots and objects that came out of files of the tool's user, and what a run folder keeps of them.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "common/report.hpp"

namespace tool {

// Files that a run needs beside the library: kept in its config.json, so that nothing has to be given again.
struct OwnFiles {
  std::vector<std::string> plugins;            // paths alone: code is not run because a run's folder says so
  std::string task;                            // text of the .task file, "" of a task of the library
  std::map<std::string, std::string> robots;   // .robot texts by name
  std::map<std::string, std::string> objects;  // .object texts by name
};

// Where --task takes a task's name it takes the file of one: "FILE.task".
bool is_task_file(const std::string& word);
// Name of the file's task, which is registered when it is first asked for. Failure with line and key.
std::string task_of_file(const std::string& file);
// The word, or the name of the task in the file that it names.
std::string task_name(const std::string& word);

void remember_plugin(const std::string& path);
void remember_robot(const std::string& name, const std::string& text);
void remember_object(const std::string& name, const std::string& text);
// What the task of that name needs of what was loaded.
OwnFiles own_files(const std::string& task);
// Loads what is not there yet. Failure, which begins with `where`, when a name stands for something else.
void load_own_files(const std::string& task, const OwnFiles& files, const std::string& where);

}  // namespace tool
