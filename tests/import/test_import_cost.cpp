// Small files that would cost much: each one of a generator of them is read, or refused, by a process that may take
// 200 MB more than it has and 10 s of its processor (a wide bound: what is wrong here takes minutes or all memory).
#include <gtest/gtest.h>
#include <redman/import.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include "capi/import/import.hpp"

namespace {

namespace fs = std::filesystem;
constexpr size_t kMostMemory = size_t{200} << 20;  // bytes
// Of a processor. ThreadSanitizer makes the same work more than ten times as long (.9 s became 13 s).
#ifdef __SANITIZE_THREAD__
constexpr rlim_t kMostSeconds = 30;
#else
constexpr rlim_t kMostSeconds = 10;
#endif

std::string times(size_t count, const std::function<std::string(size_t)>& text) {
  std::string out;
  for (size_t i = 0; i < count; ++i) out += text(i);
  return out;
}
std::string n(size_t i) {
  return std::to_string(i);
}

// ---- URDF ----
const char kMass[] = "<inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\"/></inertial>";
std::string urdf(const std::string& inside) {
  return "<robot name=\"r\">" + inside + "</robot>";
}
std::string urdf_joint(const std::string& name, const std::string& parent, const std::string& child,
                       const char* type = "fixed", const std::string& more = "") {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent +
         "\"/><child link=\"" + child + "\"/>" + more + "</joint>";
}
const char kMoves[] = "<axis xyz=\"0 0 1\"/><limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/>";

std::string many_attributes() {
  return "<robot name=\"c\" " + times(200000, [](size_t i) { return "a" + n(i) + "=\"1\" "; }) +
         "><link name=\"a\"/></robot>";
}
std::string many_elements_with_attributes() {
  return urdf(times(6000, [](size_t) {
    return "<a " + times(250, [](size_t i) { return "a" + n(i) + "=\"\" "; }) + "/>";
  }));
}
std::string star_of_links() {
  return urdf(times(40000, [](size_t i) { return "<link name=\"l" + n(i) + "\"/>"; }) +
              times(39999, [](size_t i) { return urdf_joint("j" + n(i), "l0", "l" + n(i + 1)); }));
}
std::string links_apart() {
  return urdf(times(40000, [](size_t i) { return "<link name=\"l" + n(i) + "\"/>"; }));
}
std::string mimic_chain() {
  return urdf("<link name=\"l0\"/>" + times(20000, [](size_t i) {
                return "<link name=\"l" + n(i + 1) + "\">" + kMass + "</link>" +
                       urdf_joint("j" + n(i), "l0", "l" + n(i + 1), "revolute",
                                  kMoves + ("<mimic joint=\"j" + n(i + 1)) + "\"/>");
              }));
}
std::string two_links(const std::string& in_the_second) {
  return urdf("<link name=\"a\"/><link name=\"b\">" + std::string(kMass) + in_the_second + "</link>" +
              urdf_joint("j", "a", "b", "revolute", kMoves));
}
std::string same_names() {
  return two_links(times(4096, [](size_t) {
    return std::string("<collision name=\"a\"><geometry><sphere radius=\"1\"/></geometry></collision>");
  }));
}
std::string shapes_in_each_other() {
  const std::string shapes = times(63, [](size_t) {
    return std::string("<collision><geometry><box size=\"1 1 1\"/></geometry></collision>");
  });
  return urdf("<link name=\"l0\"/>" + times(64, [&](size_t i) {
                return "<link name=\"l" + n(i + 1) + "\">" + kMass + shapes + "</link>" +
                       urdf_joint("j" + n(i), "l" + n(i), "l" + n(i + 1), "revolute", kMoves);
              }));
}
std::string deep_elements() {
  return urdf(times(50000, [](size_t) { return std::string("<a>"); }));
}
std::string comments() {
  return urdf(times(1000000, [](size_t) { return std::string("<!---->"); }));
}
std::string texts_between() {
  return urdf(times(1000000, [](size_t) { return std::string("<a/>x"); }));
}
std::string long_name() {
  return urdf("<link name=\"" + std::string(4000000, 'x') + "\"/>" +
              times(2000, [](size_t i) { return urdf_joint("j" + n(i), "b", "c"); }));
}
std::string laughs() {
  std::string out = "<!DOCTYPE r [<!ENTITY l0 \"lol\">";
  for (size_t i = 1; i < 30; ++i)
    out += "<!ENTITY l" + n(i) + " \"" + times(10, [&](size_t) { return "&l" + n(i - 1) + ";"; }) + "\">";
  return out + "]><robot name=\"&l29;\"/>";
}

// ---- MJCF ----
std::string mjcf(const std::string& inside, const std::string& in_body = "") {
  return "<mujoco>" + inside +
         "<worldbody><body name=\"a\"><body name=\"b\"><joint name=\"j\" range=\"-1 1\"/><joint name=\"k\" "
         "axis=\"1 0 0\" range=\"-1 1\"/><geom size=\"1\"/>" +
         in_body + "</body></body></worldbody></mujoco>";
}
std::string classes_side_by_side() {
  return "<mujoco><default class=\"main\">" +
         times(4000,
               [](size_t i) { return "<" + std::string(i % 2 ? "geom" : "joint") + " group=\"0\"/>"; }) +
         times(4000, [](size_t i) { return "<default class=\"c" + n(i) + "\"/>"; }) +
         "</default><worldbody/></mujoco>";
}
std::string classes_in_each_other() {
  const size_t deep = 90;
  return mjcf("<default class=\"main\">" +
                  times(deep,
                        [](size_t i) {
                          return "<default class=\"c" + n(i) + "\">" +
                                 times(500, [](size_t) { return std::string("<joint damping=\"1\"/>"); });
                        }) +
                  times(deep, [](size_t) { return std::string("</default>"); }) + "</default>",
              times(50000, [](size_t) {
                return std::string("<geom class=\"c89\" contype=\"0\" conaffinity=\"0\" mass=\"0\"/>");
              }));
}
std::string long_default() {
  return mjcf(
      "<default><geom size=\"1" + std::string(1000000, ' ') + "\"/></default>",
      times(50000, [](size_t) { return std::string("<geom contype=\"0\" conaffinity=\"0\" mass=\"0\"/>"); }));
}
std::string excludes() {
  return mjcf("<contact>" +
                  times(50000, [](size_t i) { return "<exclude body1=\"x" + n(i) + "\" body2=\"b\"/>"; }) +
                  "</contact>",
              times(2000, [](size_t) { return std::string("<geom size=\"1\"/>"); }) +
                  "<body name=\"c\"><joint range=\"-1 1\"/>" +
                  times(2000, [](size_t) { return std::string("<geom size=\"1\"/>"); }) + "</body>");
}
// As much as the bounds leave: 16 MB of text, 240,000 elements, 390,000 attributes.
std::string full() {
  return mjcf("", times(130000,
                        [](size_t i) {
                          return "<geom name=\"" + std::string(30, 'x') + n(i) +
                                 "\" contype=\"0\" mass=\"0\"/>";
                        })) +
         std::string(1000, ' ');
}
std::string sites_and_welds() {
  return mjcf(
      "<equality>" +
          times(100000,
                [](size_t) { return std::string("<weld body1=\"none\" body2=\"b\" active=\"true\"/>"); }) +
          "</equality>",
      times(100000, [](size_t i) { return "<site name=\"s" + n(i) + "\"/>"; }));
}
std::string coupled(const char* leader) {
  return mjcf("<equality>" +
                  times(4000,
                        [&](size_t i) {
                          return "<joint joint1=\"q" + n(i + 1) + "\" joint2=\"q" +
                                 (*leader ? leader : n(i)) + "\"/>";
                        }) +
                  "</equality><actuator>" +
                  times(40000, [](size_t i) { return "<motor joint=\"q" + n(i % 4000) + "\"/>"; }) +
                  "</actuator>",
              times(4001, [](size_t i) { return "<joint name=\"q" + n(i) + "\" range=\"-1 1\"/>"; }));
}
std::string chain_of_followers() {
  return coupled("");
}
std::string star_of_followers() {
  return coupled("0");
}
// Hulls, whose work grows with the square of their corners.
std::string hulls() {
  const auto sphere = [](size_t k) {
    return times(2000, [&](size_t i) {
      const double z = 1 - (2 * static_cast<double>(i) + 1) / 2000, r = std::sqrt(1 - z * z),
                   a = 2.4 * static_cast<double>(i) + static_cast<double>(k);
      return std::to_string(r * std::cos(a)) + ' ' + std::to_string(r * std::sin(a)) + ' ' +
             std::to_string(z) + ' ';
    });
  };
  return mjcf("<asset>" +
                  times(100,
                        [&](size_t k) {
                          return "<mesh name=\"m" + n(k) + "\" inertia=\"convex\" vertex=\"" + sphere(k) +
                                 "\"/>";
                        }) +
                  "</asset>",
              times(100, [](size_t k) { return "<geom type=\"mesh\" mesh=\"m" + n(k) + "\"/>"; }));
}
std::string names_of_parts() {  // each '_' is where a part of a name begins, which the nearest may be like
  return mjcf("", times(10, [](size_t i) {
                std::string name;
                while (name.size() < 1000000) name += "a_";
                return "<site name=\"" + name + n(i) + "\"/>";
              }));
}
std::string equalities() {
  return mjcf("<equality>" +
              times(100000, [](size_t) { return std::string("<joint joint1=\"j\" joint2=\"k\"/>"); }) +
              "</equality>");
}
std::string tendons() {
  return mjcf("<tendon><fixed name=\"t\">" +
              times(100000,
                    [](size_t i) {
                      return std::string(i % 2 ? "<joint joint=\"j\" coef=\"1\"/>"
                                               : "<joint joint=\"k\" coef=\"1\"/>");
                    }) +
              "</fixed></tendon><actuator>" +
              times(1000, [](size_t) { return std::string("<motor tendon=\"t\"/>"); }) + "</actuator>");
}
std::string limited_tendons() {
  return mjcf("<tendon>" +
              times(60000,
                    [](size_t) {
                      return std::string(
                          "<fixed range=\"0 1\"><joint joint=\"j\" coef=\"1\"/><joint joint=\"k\" "
                          "coef=\"1\"/></fixed>");
                    }) +
              "</tendon>");
}
std::string joints() {
  return mjcf("", times(60000, [](size_t i) { return "<joint name=\"q" + n(i) + "\" range=\"-1 1\"/>"; }));
}
std::string sites() {
  return mjcf("", times(100000, [](size_t i) { return "<site name=\"s" + n(i) + "\"/>"; }));
}
std::string mesh_names() {
  return mjcf("<asset>" +
                  times(50000,
                        [](size_t i) {
                          return "<mesh name=\"m" + n(i) + "\" vertex=\"0 0 0 1 0 0 0 1 0 0 0 1\"/>";
                        }) +
                  "</asset>",
              times(50000, [](size_t i) {
                return "<geom mesh=\"m" + n(i) +
                       "\" type=\"mesh\" contype=\"0\" "
                       "conaffinity=\"0\"/>";
              }));
}

// ---- TOML ----
std::string press(const std::string& more, const std::string& drive = "\"*\"") {
  return "[task]\nname = \"cost\"\n[[robot]]\nname = \"r\"\nhand = \"shadow\"\ndrive = [" + drive +
         "]\n[[observe]]\nterm = \"joints\"\nof = \"r\"\n[[cost]]\nname = \"c\"\nterm = \"effort\"\nof = "
         "\"r\"\nabove = 1\n" +
         more;
}
std::string stars(size_t count) {
  return press("", '"' + std::string(count, '*') + "#\", \"*\"");
}
std::string many_patterns() {
  return press("",
               times(250, [](size_t) { return "\"" + std::string(1000, '*') + "a*b*c*d#\", "; }) + "\"*\"");
}
std::string many_listed() {
  return press("[[reward]]\nterm = \"effort\"\nweight = 1\njoints = [" +
               times(3000, [](size_t) { return std::string("\"*?*?*?*?*?*?\", "); }) + "]\n");
}
std::string rows(const char* row, size_t count) {
  return press(times(count, [&](size_t i) {
    std::string text = row;
    for (size_t at; (at = text.find('@')) != std::string::npos;) text.replace(at, 1, n(i));
    return text;
  }));
}
std::string commas(size_t count) {
  return press("x = [" + times(count, [](size_t) { return std::string("1,"); }) + "]\n");
}
std::string dotted(size_t parts) {
  return times(parts, [](size_t) { return std::string("a."); }) + "a = 1\n";
}
std::string dotted_header(size_t parts) {
  return "[" + times(parts, [](size_t) { return std::string("a."); }) + "a]\n";
}
std::string dotted_in_a_table(size_t parts) {
  return "x = { " + times(parts, [](size_t) { return std::string("a . "); }) + "a = 1 }\n";
}
std::string brackets(size_t count) {
  return "x = " + std::string(count, '[') + '\n';
}

struct Case {
  const char* name;
  const char* kind;  // "urdf", "mjcf", "task", "robot", "object"
  std::string text;
};
std::vector<Case> texts() {
  return {
      {"attributes", "urdf", many_attributes()},
      {"attributes of many", "urdf", many_elements_with_attributes()},
      {"star of links", "urdf", star_of_links()},
      {"links apart", "urdf", links_apart()},
      {"mimic chain", "urdf", mimic_chain()},
      {"same names", "urdf", same_names()},
      {"shapes in each other", "urdf", shapes_in_each_other()},
      {"deep elements", "urdf", deep_elements()},
      {"comments", "urdf", comments()},
      {"texts between", "urdf", texts_between()},
      {"long name", "urdf", long_name()},
      {"entities", "urdf", laughs()},
      {"classes side by side", "mjcf", classes_side_by_side()},
      {"classes in each other", "mjcf", classes_in_each_other()},
      {"long default", "mjcf", long_default()},
      {"excludes", "mjcf", excludes()},
      {"full", "mjcf", full()},
      {"sites and welds", "mjcf", sites_and_welds()},
      {"chain of followers", "mjcf", chain_of_followers()},
      {"star of followers", "mjcf", star_of_followers()},
      {"names of parts", "mjcf", names_of_parts()},
      {"hulls", "mjcf", hulls()},
      {"equalities", "mjcf", equalities()},
      {"tendons", "mjcf", tendons()},
      {"limited tendons", "mjcf", limited_tendons()},
      {"joints", "mjcf", joints()},
      {"sites", "mjcf", sites()},
      {"mesh names", "mjcf", mesh_names()},
      {"stars", "task", stars(12)},
      {"many stars", "task", stars(100000)},
      {"patterns", "task", many_patterns()},
      {"listed joints", "task", many_listed()},
      {"commas", "task", commas(2000000)},
      {"commas of a robot", "robot", commas(2000000)},
      {"commas of an object", "object", commas(2000000)},
      {"dotted key", "task", dotted(200000)},
      {"dotted header", "task", dotted_header(200000)},
      {"dotted in a table", "task", dotted_in_a_table(200000)},
      {"brackets", "object", brackets(100000)},
      {"costs", "task", rows("[[cost]]\nname = \"c@\"\nterm = \"effort\"\nof = \"r\"\nabove = 1\n", 4000)},
      {"rewards", "task", rows("[[reward]]\nterm = \"effort\"\nof = \"r\"\nweight = 1\n", 4000)},
      {"materials", "task", rows("[[material]]\nname = \"m@\"\n", 4000)},
      {"frictions", "task", rows("[[friction]]\nbetween = [\"default\", \"default\"]\nmu = 1\n", 4000)},
      {"statics", "task",
       rows("[[static]]\nname = \"s@\"\nkind = \"sphere\"\nsize = [1]\np = [@, 0, 100]\n", 4000)},
      {"bodies", "task",
       rows("[[body]]\nname = \"b@\"\nmass = 1\nkind = \"sphere\"\nsize = [0.1]\np = [@, 0, 100]\n", 3000)}};
}

rdm_result read(const Case& c, std::string* text) {
  rdm_import_config o;
  rdm_import_config_init(&o, sizeof o);
  rdm_import* i = nullptr;
  int32_t task = -1;
  rdm_result r = RDM_OK;
  const std::string kind = c.kind;
  if (kind == "task")
    r = rdm_import_read_task(&task, c.text.data(), c.text.size(), nullptr);
  else if (kind == "object")
    r = rdm_import_read_object(&i, c.text.data(), c.text.size());
  else {
    o.format = kind == "urdf" ? RDM_IMPORT_URDF : kind == "mjcf" ? RDM_IMPORT_MJCF : RDM_IMPORT_ROBOT;
    r = rdm_import_read(&i, c.text.data(), c.text.size(), &o);
  }
  *text = r ? rdm_import_error() : "taken";
  rdm_import_destroy(i);
  return r;
}

// No more than kMostMemory beside what there is. The sanitizers reserve address space as they like.
void limit_memory() {
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  const rlimit space{pages * static_cast<size_t>(sysconf(_SC_PAGESIZE)) + kMostMemory, RLIM_INFINITY};
  setrlimit(RLIMIT_AS, &space);
#endif
}

// Runs `work` in a process of its own, which may take so much and no more; what it answers, and what it took.
struct Cost {
  bool ended;
  double seconds;
  size_t bytes;
  std::string text;
};
Cost measured(const std::function<std::string()>& work) {
  int ends[2];
  EXPECT_EQ(pipe(ends), 0);
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    const rlimit cpu{kMostSeconds, kMostSeconds}, core{0, 0};
    setrlimit(RLIMIT_CPU, &cpu);
    setrlimit(RLIMIT_CORE, &core);
    limit_memory();
    rusage before{};
    getrusage(RUSAGE_SELF, &before);
    std::string text = work();
    rusage after{};
    getrusage(RUSAGE_SELF, &after);
    text = n(static_cast<size_t>(after.ru_maxrss - before.ru_maxrss) << 10) + " " + text;
    ssize_t done = write(ends[1], text.data(), text.size());
    _exit(done < 0);
  }
  close(ends[1]);
  std::string text;
  char part[4096];
  for (ssize_t got; (got = ::read(ends[0], part, sizeof part)) > 0;)
    text.append(part, static_cast<size_t>(got));
  close(ends[0]);
  int status = 0;
  rusage took{};
  wait4(child, &status, 0, &took);
  Cost out{WIFEXITED(status) && WEXITSTATUS(status) == 0, 0, 0, text};
  out.seconds = static_cast<double>(took.ru_utime.tv_sec + took.ru_stime.tv_sec) +
                1e-6 * static_cast<double>(took.ru_utime.tv_usec + took.ru_stime.tv_usec);
  const size_t blank = text.find(' ');
  if (blank != std::string::npos)
    out.bytes = std::stoull(text.substr(0, blank)), out.text = text.substr(blank + 1);
  return out;
}

void expect_cheap(const std::string& name, size_t size, const std::function<std::string()>& work) {
  const Cost c = measured(work);
  std::printf("%-24s %9zu bytes %7.2f s %6zu MB  %s\n", name.c_str(), size, c.seconds, c.bytes >> 20,
              c.text.substr(0, 100).c_str());
  EXPECT_TRUE(c.ended) << name << ": more than " << kMostSeconds << " s, or a crash";
  EXPECT_EQ(c.text.find("out of memory"), std::string::npos) << name;
}

TEST(ImportCost, TextsAreCheap) {
  for (const Case& c : texts())
    expect_cheap(c.name, c.text.size(), [&] {
      std::string text;
      read(c, &text);
      return text;
    });
}

class Folder {
 public:
  Folder() {
    char name[] = "/tmp/redman-cost-XXXXXX";
    path_ = mkdtemp(name);
  }
  ~Folder() { fs::remove_all(path_); }
  std::string put(const std::string& name, const std::string& text) const {
    std::ofstream(path_ + "/" + name, std::ios::binary) << text;
    return path_ + "/" + name;
  }
  std::string path(const std::string& name) const { return path_ + "/" + name; }

 private:
  std::string path_;
};

std::string read_file(const std::string& path) {
  rdm_import* i = nullptr;
  const rdm_result r = rdm_import_read_file(&i, path.c_str(), nullptr);
  rdm_import_destroy(i);
  return r ? rdm_import_error() : "taken";
}

TEST(ImportCost, FilesTogetherAreCheap) {
  const Folder f;
  const auto includes = [](const char* file, size_t count) {
    return "<mujoco>" +
           times(count, [&](size_t) { return std::string("<include file=\"") + file + "\"/>"; }) +
           "</mujoco>";
  };
  f.put("c.xml", "<mujoco><!--" + std::string(8 << 20, 'x') + "--></mujoco>");
  f.put("b.xml", includes("c.xml", 400));
  f.put("empty.xml", "<mujoco/>");
  f.put("e.xml", includes("empty.xml", 20000));
  f.put("self.xml", includes("self.xml", 2));
  const std::string deep(200, '/');
  std::string far =
      "<mujoco><include file=\"" + std::string(2000, '/') + f.path("many.xml") + "\"/></mujoco>";
  f.put("many.xml", "<mujoco>" + times(100000, [](size_t) { return std::string("<a/>"); }) + "</mujoco>");
  std::string cube;
  for (size_t i = 0; i < 200000; ++i)
    cube += "v " + n(i % 2) + ' ' + n(i / 2 % 2) + ' ' + n(i / 4 % 2) + '\n';
  f.put("cube.obj", cube);
  const std::string scales = two_links(times(4000, [](size_t i) {
    return "<collision><geometry><mesh filename=\"cube.obj\" scale=\"1 1 1." + n(i) +
           "\"/></geometry></collision>";
  }));
  const std::string many_files = two_links(times(20000, [](size_t i) {
    return "<collision><geometry><mesh filename=\"no" + n(i) + ".obj\"/></geometry></collision>";
  }));
  f.put("faces.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf" +
                         times(8000000, [](size_t) { return std::string(" 1"); }) + '\n');
  const std::pair<const char*, std::string> files[] = {
      {"includes of includes", includes("b.xml", 400)},
      {"empty includes", includes("e.xml", 20)},
      {"includes itself", includes("self.xml", 2)},
      {"long name of an include", far},
      {"one mesh, many scales", scales},
      {"meshes that are not there", many_files},
      {"a face of many corners",
       two_links("<collision><geometry><mesh filename=\"faces.obj\"/></geometry></collision>")}};
  for (const auto& [name, text] : files) {
    const std::string path = f.put("top.xml", text);
    expect_cheap(name, text.size(), [&] { return read_file(path); });
  }
}

// A pipe without a writer would be waited for, for ever; a device gives without end.
TEST(ImportCost, NothingButARegularFileIsRead) {
  const Folder f;
  for (const char* name : {"pipe.urdf", "pipe.xml", "pipe.stl", "pipe.task", "pipe.object"})
    ASSERT_EQ(mkfifo(f.path(name).c_str(), 0600), 0);
  fs::create_directory(f.path("folder.urdf"));
  fs::create_symlink("/dev/zero", f.path("zero.urdf"));
  const auto expect_refused = [](const std::string& what, const std::string& text) {
    EXPECT_NE(text.find("regular file"), std::string::npos) << what << ": " << text;
  };
  for (const char* name : {"pipe.urdf", "folder.urdf", "zero.urdf"})
    expect_refused(name, read_file(f.path(name)));
  expect_refused("include", read_file(f.put("i.xml", "<mujoco><include file=\"pipe.xml\"/></mujoco>")));
  expect_refused("mesh",
                 read_file(f.put("m.urdf", two_links("<collision><geometry><mesh filename=\"pipe.stl\"/>"
                                                     "</geometry></collision>"))));
  int32_t task = -1;
  EXPECT_NE(rdm_import_read_task_file(&task, f.path("pipe.task").c_str()), RDM_OK);
  expect_refused("task", rdm_import_error());
  rdm_import* i = nullptr;
  EXPECT_NE(rdm_import_read_object_file(&i, f.path("pipe.object").c_str()), RDM_OK);
  expect_refused("object", rdm_import_error());
}

// Twice the file is twice the work: what is counted grows no faster than what is read.
TEST(ImportCost, WorkGrowsWithTheFile) {
  const auto steps = [](size_t count) {
    rdm::import::Draft draft;
    rdm::import::Options options;
    const std::string text =
        mjcf("<default><default class=\"c\"/></default>", times(count, [](size_t) {
               return std::string("<geom class=\"c\" contype=\"0\" conaffinity=\"0\" mass=\"0\"/>");
             }));
    rdm::import::read_mjcf(text, options, &draft);
    return draft.budget.spent(rdm::import::Cost::kSteps);
  };
  const size_t few = steps(1000), many = steps(2000);
  EXPECT_GT(few, 0u);
  EXPECT_LE(many, 2 * few + 100);
}

}  // namespace
