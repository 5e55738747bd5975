// Demonstration scripts: what is read and fits the pool gives finite actions.
#include "../fuzz.hpp"
#include "common/report.hpp"
#include "demo/player.hpp"
#include "demo/script.hpp"

namespace hard {

std::vector<Bytes> seeds() {
  std::vector<Bytes> out;
  for (const tool::CarriedDemo* d = tool::kCarriedDemos; d->name; ++d) {
    const std::string text = d->text;
    out.push_back(bytes_of(text.substr(0, 2000)));
  }
  out.push_back(bytes_of("task grasp\nphase a 1\n  FFJ2 0.5 at 0 over 0.1\n"));
  return out;
}
void whole(unsigned char*, size_t) {}
size_t fixed_bytes() {
  return 0;
}

void one(const unsigned char* data, size_t size) {
  static redman::Pool* pool = [] {
    auto* p = new redman::Pool(redman::pool_config("hand_over_safe_finger"));
    p->reset();
    return p;
  }();
  try {
    const tool::DemoScript script = tool::parse_demo(reinterpret_cast<const char*>(data), size, "input");
    tool::Demo demo(script, *pool);
    const uint8_t mask[1] = {1};
    demo.restart(mask);
    for (int i = 0; i < 4; ++i) {
      demo.act(*pool, mask);
      for (float a : pool->action()[0]) HARD_REQUIRE(std::isfinite(a), "an action is not finite");
    }
  } catch (const tool::Failure& e) {
    HARD_REQUIRE(*e.what(), "no text");
  } catch (const tool::Usage& e) {
    HARD_REQUIRE(*e.what(), "no text");
  } catch (const redman::Error& e) {
    HARD_REQUIRE(*e.what(), "no text");
  }
}

}  // namespace hard
