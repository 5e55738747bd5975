// Tasks as text: what is read is registered, stepped and removed; what is not is refused with a text and
// leaves nothing behind.
#include <redman/import.h>

#include <cstring>

#include "../fuzz.hpp"

namespace hard {
namespace {

const char kSmall[] =
    "[task]\nname=\"f\"\nmax_steps=4\n[options]\nfrequency=50\nk={default=0.5,low=0,high=2}\n"
    "[[tree]]\nname=\"c\"\np=[0,0,0.5]\ncontrol=\"delta\"\nstart={s=\"0..0.1\"}\n[[tree.link]]\nname="
    "\"l\"\njoint=\"s\"\n"
    "parent=\"root\"\nkind=\"prismatic\"\naxis=[1,0,0]\nrange=[-0.2,0.2]\nkp=400\nkd=40\neffort=100\nmass=1\n"
    "moment=[0.01,0.01,0.01,0,0,0]\n[[tree.shape]]\nname=\"x\"\nlink=\"l\"\nkind=\"box\"\nsize=[0.1,0.1,0.1]"
    "\n"
    "[[body]]\nname=\"b\"\nkind=\"sphere\"\nsize=[0.1]\nmass=\"$k\"\np=[\"0.5..1\",0.3,0.1]\nrpy=[0,\"0..1\","
    "0]\n"
    "[[static]]\nname=\"t\"\nkind=\"plane\"\n[[draw]]\nwhat=\"body_mass\"\nof=\"b\"\nfactor=\"1..2\"\n"
    "[[observe]]\nterm=\"joints\"\nof=\"c\"\n[[observe]]\nterm=\"position\"\na={on=\"b\",p=[0,0,1]}\nfrom="
    "\"c\"\n"
    "[[reward]]\nterm=\"distance\"\na=\"b\"\nb=[0,0,1]\ncurve=\"bell\"\nwidth=0.1\nchange=true\nweight=2\n"
    "[[cost]]\nname=\"m\"\nterm=\"touch\"\na=\"c*\"\nb=\"b\"\nlimit=1\n[[success]]\nterm=\"moved\"\na=\"b\"\n"
    "above=0.1\n[[fall]]\nterm=\"leaves_box\"\na=\"b\"\nlow=[-1,-1,-1]\nhigh=[1,1,1]\nabove=0\n"
    "[end]\nhold=2\nbonus=1\n[learn]\nhorizon=20\n";
const char kHand[] =
    "[task]\nname=\"g\"\n[[robot]]\nname=\"r\"\narm=\"ur5e\"\nhand=\"allegro\"\ngravity=true\ncompensate="
    "true\n"
    "reach={p=[0.4,0,0.4],rpy=[3.1,0,0]}\ndrive=[\"wrist*\"]\ncontrol=\"velocity\"\n[[observe]]\nterm=\"tip_"
    "forces\"\n"
    "a=\"r.ff\"\n[[cost]]\nname=\"e\"\nterm=\"effort\"\nof=\"r\"\nabove=0.5\n";

}  // namespace

std::vector<Bytes> seeds() {
  return {bytes_of(kSmall), bytes_of(kHand)};
}
void whole(unsigned char*, size_t) {}
size_t fixed_bytes() {
  return 0;
}

void one(const unsigned char* data, size_t size) {
  int32_t task = -1;
  const rdm_result r = rdm_import_read_task(&task, data, size, "f.task");
  if (r != RDM_OK) {
    HARD_REQUIRE(task == -1 && rdm_import_error()[0] != 0 && r != RDM_ERROR_INTERNAL, "%d %s", r,
                 rdm_import_error());
    HARD_REQUIRE(!std::strchr(rdm_import_error(), '\n'), "%s", rdm_import_error());
    return;
  }
  rdm_task info{};
  info.struct_size = sizeof info;
  HARD_REQUIRE(rdm_task_at(task, &info) == RDM_OK, "%s", rdm_last_error());
  rdm_pool_config c;
  rdm_pool_config_init(&c, sizeof c);
  c.task = info.name;
  c.num_envs = 2;
  rdm_pool* pool = nullptr;
  if (rdm_pool_create(&pool, &c) == RDM_OK && rdm_pool_reset(pool, nullptr, nullptr) == RDM_OK)
    for (int i = 0; i < 5; ++i) {
      HARD_REQUIRE(rdm_pool_baseline(pool, RDM_BASELINE_RANDOM) == RDM_OK, "%s", rdm_last_error());
      if (const rdm_result stepped = rdm_pool_step(pool); stepped != RDM_OK) {
        HARD_REQUIRE(stepped != RDM_ERROR_INTERNAL, "%s", rdm_last_error());
        break;
      }
    }
  rdm_pool_destroy(pool);
  HARD_REQUIRE(rdm_task_destroy(task) == RDM_OK, "%s", rdm_last_error());
}

}  // namespace hard
