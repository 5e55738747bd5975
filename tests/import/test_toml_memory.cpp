// Memory that is refused while TOML is read: MEMORY, whichever request it is, and neither another reason nor the
// end of the process.
#include <gtest/gtest.h>
#include <redman/import.h>

#include <cstring>
#include <functional>

#include "refuse_new.hpp"

namespace {

const char kTask[] = R"(# a comment
[task]
name = "refused"
max_steps = 40
[options]
k = {default = 0.5, low = 0, high = 2}
[[robot]]
name = "r"
hand = "shadow"
drive = ["*"]
[[observe]]
term = "joints"
of = "r"
[[reward]]
term = "effort"
of = "r"
weight = -0.25
[[cost]]
name = "c"
term = "effort"
of = "r"
above = 1.5e-1
)";
const char kObject[] = R"(name = "box"
mass = 0.2
[[shape]]
kind = "box"
size = [0.1, 0.2, 3.5e-2]
)";
const char kBroken[] = "[task]\nname = \"x\"\nmax_steps = 4x\n";

using Read = std::function<rdm_result(const char*, size_t)>;
using Remove = std::function<void()>;  // of what was read, with memory again

// Refuses every request in turn, alone or with all that follow; how many there are.
int64_t sweep(const char* text, rdm_result otherwise, bool once, const Read& read, const Remove& remove) {
  const size_t size = std::strlen(text);
  EXPECT_EQ(read(text, size), otherwise) << rdm_import_error();
  remove();
  for (int64_t at = 0;; ++at) {
    rdm_result r = RDM_OK;
    bool happened = false;
    {
      const RefuseNew refusal(at, once);
      r = read(text, size);
      happened = refusal.happened();
    }
    remove();
    EXPECT_TRUE(r == otherwise || (happened && r == RDM_ERROR_MEMORY))
        << "request " << at << ": " << r << " " << rdm_import_error();
    if (!happened) return at;
  }
}

TEST(TomlMemory, OfATask) {
  int32_t task = -1;
  const Read read = [&](const char* text, size_t size) {
    return rdm_import_read_task(&task, text, size, "x.task");
  };
  const Remove remove = [&] {
    if (task >= 0) {
      EXPECT_EQ(rdm_task_destroy(task), RDM_OK) << rdm_last_error();
    }
    task = -1;
  };
  for (const bool once : {true, false}) {
    EXPECT_GT(sweep(kTask, RDM_OK, once, read, remove), 200);
    EXPECT_GT(sweep(kBroken, RDM_ERROR_FORMAT, once, read, remove), 10);
  }
}

TEST(TomlMemory, OfAnObject) {
  rdm_import* i = nullptr;
  const Read read = [&](const char* text, size_t size) { return rdm_import_read_object(&i, text, size); };
  const Remove remove = [&] {
    rdm_import_destroy(i);
    i = nullptr;
  };
  for (const bool once : {true, false}) EXPECT_GT(sweep(kObject, RDM_OK, once, read, remove), 40);
}

}  // namespace
