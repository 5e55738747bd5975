/* The self-test of an exported policy on a bare Cortex-M under qemu, then one line: instructions of a call,
 * and bytes of stack. The exit status is the self-test's. POLICY is the file, NAME its prefix; with EYES it
 * sees a cloud of as many points as it learned from, with MEMORY it has a state. */
#define main self_test
#include POLICY
#undef main
#define JOIN(a, b) a##b
#define SYMBOL(name, part) JOIN(name, part)

#ifdef EYES
static float cloud[3 * SYMBOL(NAME, _num_points)];
#define ACT(obs, action) SYMBOL(NAME, _act_points)(obs, cloud, SYMBOL(NAME, _num_points), action)
#elif defined(MEMORY)
static float memory[SYMBOL(NAME, _state_size)];
#define ACT(obs, action) SYMBOL(NAME, _act)(obs, memory, action)
#else
#define ACT(obs, action) SYMBOL(NAME, _act)(obs, action)
#endif

extern uint32_t stack_low, stack_top;
void reset(void);
__attribute__((section(".vectors"), used)) static void* const vectors[2] = {&stack_top, (void*)reset};

#define SYSTICK ((volatile uint32_t*)0xe000e010)
enum {
  kWrite0 = 4,
  kExitExtended = 0x20,
  kApplicationExit = 0x20026,
  kTick = 40 /* instructions: 25 MHz, 1 ns each */
};

static void semihost(int operation, const void* argument) {
  register int r0 __asm__("r0") = operation;
  register const void* r1 __asm__("r1") = argument;
  __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
}

static void print(uint32_t value, char end) {
  char text[12], *at = text + 11;
  *at = 0;
  *--at = end;
  do *--at = (char)('0' + value % 10);
  while (value /= 10);
  semihost(kWrite0, at);
}

/* Bytes of stack down to the lowest word that a call changes, with this function's own. */
static uint32_t stack_of(const float* obs, float* action) {
  volatile uint32_t* low = &stack_low;
  uint32_t *const frame = (uint32_t*)__builtin_frame_address(0), *at;
  for (at = &stack_low; at < frame - 16; ++at) *(volatile uint32_t*)at = 0xa5a5a5a5u;
  ACT(obs, action);
  while (*low == 0xa5a5a5a5u) ++low;
  return (uint32_t)((char*)frame - (char*)low);
}

void reset(void) {
  static float obs[SYMBOL(NAME, _obs_dim)], action[SYMBOL(NAME, _action_dim)];
  uint32_t begin, ticks, random = 1, exit[2] = {kApplicationExit, 0};
#ifdef __ARM_FP
  *(volatile uint32_t*)0xe000ed88 |= 0xfu << 20; /* the floating-point unit */
  __asm__ volatile("dsb; isb");
#endif
  exit[1] = (uint32_t)self_test();
  SYMBOL(NAME, _draw)(1, &random, obs);
#ifdef EYES
  SYMBOL(NAME, _draw_points)(&random, cloud);
#endif
  SYSTICK[1] = 0xffffff;
  SYSTICK[2] = 0;
  SYSTICK[0] = 5; /* on, by the processor's clock */
  begin = SYSTICK[2];
  ACT(obs, action);
  ticks = (begin - SYSTICK[2]) & 0xffffff;
  if (SYSTICK[0] & 1u << 16) ticks += 1u << 24; /* once around */
  print(ticks * kTick, ' ');
  print(stack_of(obs, action), '\n');
  semihost(kExitExtended, exit);
}
