// The text of a policy's C file, but for its numbers. Words in capitals are put in: NAME, OBS_DIM, ...
#pragma once

namespace tool {

inline constexpr const char* kHead =
    R"(/* Policy of TASK, exported by redman VERSION. C99 and C++; no heap, no library, no state of its own: call it from
 * any thread. STACK bytes of stack and a little.
 *
 *   float obs[NAME_obs_dim], BESIDEaction[NAME_action_dim];
 *   CALL;
 *
 * One decision, to be held for RATE: the MEAN_ACTION.
 * Every action is NaN when an observation is not finite, or the network overflows on it: test one for
 * action == action before it moves anything.
HELDSEES *
 * With REDMAN_POLICY_HEADER defined this file declares only. With REDMAN_POLICY_TEST it is a program: status 0
 * when the actions are the policy's, 1 when not, 2 when a number is not what was exported, 3 when an
 * observation that is not finite is taken.
 *
 * Network: SHAPE. Weights: WEIGHTS.
 * Layout of observations and actions: LAYOUT.
)";

// Of one that is held to the guards of its task.
inline constexpr const char* kHeld =
    R"( *
 * Guards: whatever the network says, these entries stay within bounds that keep a cost of the task at 0.
)";

// Of a policy with eyes.
inline constexpr const char* kSees =
    R"( *
 * points [count][3]: the cloud, m, in the frame that it was trained in (the world's). A point counts as whole
 * millimetres from NAME_origin, within +-32.767 m. Any count from 1 on, in any order: what comes twice
 * changes nothing. It learned from clouds of NAME_num_points. Every action is NaN when a point is not finite, or there
 * is none.
)";
inline constexpr const char* kSeesClasses =
    R"( * point_class [count]: what each point lies on, less than NAME_num_point_classes; every action is NaN for another.
)";

inline constexpr const char* kSeesColors =
    R"( * point_color [count][3]: its colour, red, green and blue.
)";

// Of a policy with a memory.
inline constexpr const char* kRemembers =
    R"( *
 * state [NAME_state_size]: what it remembers of an episode, the caller's: all zeros where one begins, and from one
 * decision to the next as FUNCTION leaves it. Where an action is NaN it stays as it was.
)";

inline constexpr const char* kDeclarations = R"( */
#ifndef NAME_DECLARED
#define NAME_DECLARED
enum { NAME_obs_dim = OBS_DIM, NAME_action_dim = ACTION_DIM, NAME_action_repeat = REPEATEYE_SIZES };
#ifdef __cplusplus
extern "C" {
#endif
DECLARATION;
#ifdef __cplusplus
}
#endif
#endif

#if !defined(REDMAN_POLICY_HEADER) && !defined(NAME_DEFINED)
#define NAME_DEFINED
#include <stdint.h>
#if defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__
#error "-ffast-math and -Ofast take away what tells NaN from numbers"
#endif

)";

inline constexpr const char* kFma = R"(
/* x y + z, rounded once, as redman itself has it: actions then are the same bytes. Where there is no such
 * instruction a double holds the product; where that is slow, twice rounded has to do, 1e-6 from there. */
static float NAME_fma(float x, float y, float z) {
#if defined(__FP_FAST_FMAF)
  return __builtin_fmaf(x, y, z);
#elif defined(__SSE2__) || defined(_M_X64)
  return (float)((double)x * (double)y + (double)z);
#else
  return x * y + z;
#endif
}
)";

inline constexpr const char* kTanh = R"(
/* x P(x^2) / Q(x^2), relative error 2e-8 before rounding. */
static float NAME_tanh(float x) {
  float u, p, q;
  x = x < -9.011f ? -9.011f : x > 9.011f ? 9.011f : x;
  u = x * x;
  p = NAME_fma(1.33350530617804e-08f, u, 2.0594981833710335e-05f);
  p = NAME_fma(p, u, 0.0034947325475513935f);
  p = NAME_fma(p, u, 0.13380305469036102f);
  p = NAME_fma(p, u, 1.0f);
  q = NAME_fma(7.768549039610662e-07f, u, 0.00032842348446138203f);
  q = NAME_fma(q, u, 0.025873728096485138f);
  q = NAME_fma(q, u, 0.4671362042427063f);
  q = NAME_fma(q, u, 1.0f);
  x = x * p / q;
  return x < -1.0f ? -1.0f : x > 1.0f ? 1.0f : x;
}
)";

inline constexpr const char* kActivateTanh = R"(
static float NAME_activation(float z) { return NAME_tanh(z); }
)";

inline constexpr const char* kElu = R"(
/* z, and e^z - 1 below 0. */
static float NAME_activation(float z) {
  float t;
  if (z > 0.0f) return z;
  t = NAME_tanh(z * 0.5f);
  return (t + t) / (1.0f - t);
}
)";

inline constexpr const char* kRelu = R"(
static float NAME_activation(float z) { return z < 0.0f ? 0.0f : z; }
)";

inline constexpr const char* kActivate = R"(
static void NAME_activate(float *x, int n) {
  int i;
  for (i = 0; i < n; ++i) x[i] = NAME_activation(x[i]);
}
)";

inline constexpr const char* kLayerFloat = R"(
/* y [out] = W x + bias; weight [out / 4][in][4]. */
static void NAME_layer(const float *weight, const float *bias, const float *x, int in, int out, float *y) {
  int i, k;
  for (i = 0; i < out; i += 4) {
    float a = 0.0f, b = 0.0f, c = 0.0f, d = 0.0f;
    for (k = 0; k < in; ++k, weight += 4) {
      a = NAME_fma(x[k], weight[0], a);
      b = NAME_fma(x[k], weight[1], b);
      c = NAME_fma(x[k], weight[2], c);
      d = NAME_fma(x[k], weight[3], d);
    }
    y[i] = a + bias[i];
    y[i + 1] = b + bias[i + 1];
    y[i + 2] = c + bias[i + 2];
    y[i + 3] = d + bias[i + 3];
  }
}
)";

inline constexpr const char* kLayerInt8 = R"(
/* sum + four numbers of a row times four of x. Bytes 0 and 2 of a word, and then 1 and 3, are what one instruction of
 * an ARM with DSP spreads into 16 bits each, hence the order of the bytes. */
#if defined(__GNUC__) && defined(__ARM_FEATURE_SIMD32) && !defined(__ARM_BIG_ENDIAN)
#include <arm_acle.h>
#define NAME_DSP
#endif
#if defined(__GNUC__)
__attribute__((always_inline))
#endif
static inline int32_t NAME_four(int32_t sum, const int8_t *w, const int16_t *q) {
#ifdef NAME_DSP
  uint32_t four;
  int32_t pair[2];
  __builtin_memcpy(&four, w, sizeof four);
  __builtin_memcpy(pair, q, sizeof pair);
  sum = __smlad(__sxtb16((int32_t)four), pair[0], sum);
  return __smlad(__sxtb16((int32_t)(four >> 8)), pair[1], sum);
#else
  return sum + w[0] * (int32_t)q[0] + w[2] * (int32_t)q[1] + w[1] * (int32_t)q[2] + w[3] * (int32_t)q[3];
#endif
}

/* y [out] = W x + bias; weight [out / 4][in / 4, rounded up][4 rows][4], of a row's four the numbers 0, 2, 1, 3, each
 * row times its scale. x is rounded to integers so small that 32 bits hold the sums. */
static void NAME_layer(const int8_t *weight, const float *scale, const float *bias, const float *x, int in, int out,
                       float *y) {
  int16_t q[WIDEST];
  const int32_t most = INT32_MAX / 127 / in;
  const float limit = most < 32767 ? (float)most : 32767.0f;
  float largest = 0.0f, unit, per;
  int i, k;
  for (k = 0; k < in; ++k) {
    const float size = x[k] < 0.0f ? -x[k] : x[k];
    if (size > largest) largest = size;
  }
  unit = largest / limit;
  per = largest > 0.0f ? limit / largest : 0.0f;
  for (k = 0; k < in; ++k) {
    const float v = NAME_fma(x[k], per, x[k] < 0.0f ? -0.5f : 0.5f);
    q[k] = (int16_t)(v > limit ? limit : v > -limit ? v : -limit);
  }
  q[in] = q[in + 1] = q[in + 2] = 0; /* up to three beside the last */
  for (i = 0; i < out; i += 4) {
    int32_t a = 0, b = 0, c = 0, d = 0;
    for (k = 0; k < in; k += 4, weight += 16) {
      a = NAME_four(a, weight, q + k);
      b = NAME_four(b, weight + 4, q + k);
      c = NAME_four(c, weight + 8, q + k);
      d = NAME_four(d, weight + 12, q + k);
    }
    y[i] = NAME_fma((float)a, unit * scale[i], bias[i]);
    y[i + 1] = NAME_fma((float)b, unit * scale[i + 1], bias[i + 1]);
    y[i + 2] = NAME_fma((float)c, unit * scale[i + 2], bias[i + 2]);
    y[i + 3] = NAME_fma((float)d, unit * scale[i + 3], bias[i + 3]);
  }
}
)";

inline constexpr const char* kActHead = R"(
DECLARATION {
  float front[FRONT], back[BACK]ROWS;
  float fault = FAULT; /* NaN once something is not finite */
  int i;
)";

// ---- latent -----------------------------------------------------------------------------------------------
inline constexpr const char* kKeepRow = R"(  for (i = 0; i < NAME_obs_dim; ++i) row[i] = front[i];
)";
// Behind the encoder's calls.
inline constexpr const char* kPutLatent = R"(  for (i = 0; i < LATENT; ++i) latent[i] = LAST[i];
  for (i = 0; i < NAME_obs_dim; ++i) front[i] = row[i];
  for (i = 0; i < LATENT; ++i) front[NAME_obs_dim + i] = latent[i];
)";

// ---- memory -----------------------------------------------------------------------------------------------
inline constexpr const char* kGates = ", gates[COUNT], part[COUNT]";

// Behind the hidden layers' calls.
inline constexpr const char* kGru = R"(  for (i = 0; i < NAME_state_size; ++i) {
    const float r = NAME_fma(0.5f, NAME_tanh(0.5f * (gates[i] + part[i])), 0.5f);
    const float z = NAME_fma(0.5f, NAME_tanh(0.5f * (gates[UNITS + i] + part[UNITS + i])), 0.5f);
    const float n = NAME_tanh(NAME_fma(r, part[TWICE + i], gates[TWICE + i]));
    next[i] = NAME_fma(z, state[i] - n, n);
  }
)";

inline constexpr const char* kHistory = R"(  for (i = 0; i < NAME_state_size; ++i) {
    front[NAME_obs_dim + i] = state[i];
    next[i] = i < KEPT ? front[NAME_kept[i]] : state[i - KEPT];
    fault += state[i] - state[i];
  }
)";

// Behind kActTail.
inline constexpr const char* kKeepState = R"(  if (fault == 0.0f)
    for (i = 0; i < NAME_state_size; ++i) state[i] = next[i];
)";

inline constexpr const char* kRow = R"(  for (i = 0; i < NAME_obs_dim; ++i) {
)";

// ---- eyes -------------------------------------------------------------------------------------------------
inline constexpr const char* kMillimetres = R"(
/* What is seen of a coordinate: whole millimetres from the origin, halves to the even one, within +-32767. */
static float NAME_millimetres(float x, float origin) {
  const double mm = 1000.0 * ((double)x - (double)origin);
  const double bound = mm > -32767.0 ? (mm < 32767.0 ? mm : 32767.0) : -32767.0;
  const int32_t k = (int32_t)bound;
  const double high = (double)k + 0.5, low = (double)k - 0.5;
  if (bound > high || (bound == high && k % 2 != 0)) return (float)(k + 1);
  if (bound < low || (bound == low && k % 2 != 0)) return (float)(k - 1);
  return (float)k;
}
)";

inline constexpr const char* kSeeHead = R"(
/* best [FEATURES]: the largest of each of the encoder's outputs over all points. Returns 0, or NaN for no cloud. */
static float NAME_see(const float *points, CHANNEL_PARAMETERSint count, float *best) {
  float front[FRONT], back[BACK];
  float fault = 0.0f;
  int i, p;
  for (i = 0; i < FEATURES; ++i) best[i] = 0.0f;
  if (count < 1) fault = fault / fault;
  for (p = 0; p < count; ++p, points += 3) {
    for (i = 0; i < 3; ++i) {
      front[i] = STEP * NAME_millimetres(points[i], NAME_origin[i]);
      fault += points[i] - points[i];
    }
)";

inline constexpr const char* kSeeClasses =
    R"(    for (i = 0; i < CLASSES; ++i) front[3 + i] = point_class[p] == i ? 1.0f : 0.0f;
    if (point_class[p] >= CLASSES) fault = (fault - fault) / (fault - fault);
)";

inline constexpr const char* kSeeColors =
    R"(    for (i = 0; i < 3; ++i) front[FIRST + i] = (float)point_color[3 * p + i] / 255.0f;
)";

inline constexpr const char* kSeeTail = R"(    for (i = 0; i < FEATURES; ++i)
      if (p == 0 || LAST[i] > best[i]) best[i] = LAST[i];
  }
  for (i = 0; i < FEATURES; ++i) fault += best[i] - best[i];
  return fault;
}
)";

// Behind all else that the actor sees.
inline constexpr const char* kPutFeatures = R"(  EYE_ACTIVATE(features, FEATURES);
  for (i = 0; i < FEATURES; ++i) front[BEHIND + i] = features[i];
)";

inline constexpr const char* kNormalise = R"(    const float z = (obs[i] - NAME_shift[i]) * NAME_scale[i];
    front[i] = z < -CLIP ? -CLIP : z > CLIP ? CLIP : z;
    fault += obs[i] - obs[i];
  }
)";

inline constexpr const char* kTake = R"(    front[i] = obs[i];
    fault += obs[i] - obs[i];
  }
)";

inline constexpr const char* kActTail = R"(  for (i = 0; i < NAME_action_dim; ++i) {
    const float a = SQUASH_OPENLAST[i]SQUASH_CLOSE;
    action[i] = a < LOWEST ? LOWEST : a > HIGHEST ? HIGHEST : a;
    fault += action[i] - action[i];
  }
  for (i = 0; i < NAME_action_dim; ++i) action[i] += fault;
)";

inline constexpr const char* kTestHead = R"(
#ifdef REDMAN_POLICY_TEST
#include <string.h>

/* An observation, and the policy's own actions on it and on those that are drawn. */
)";

inline constexpr const char* kSumFloats = R"(
static uint32_t NAME_sum_floats(uint32_t sum, const float *x, int n) {
  int i;
  for (i = 0; i < n; ++i) {
    uint32_t bits;
    memcpy(&bits, &x[i], sizeof bits);
    sum = (sum ^ bits) * 16777619u;
  }
  return sum;
}
)";

inline constexpr const char* kSumBytes = R"(
static uint32_t NAME_sum_bytes(uint32_t sum, const int8_t *x, int n) {
  int i;
  for (i = 0; i < n; ++i) sum = (sum ^ (uint8_t)x[i]) * 16777619u;
  return sum;
}
)";

inline constexpr const char* kDraw = R"(
static void NAME_draw(int row, uint32_t *random, float *obs) {
  const float spread = row + 1 < ROWS ? SPREAD : FAR;
  int i;
  for (i = 0; i < NAME_obs_dim; ++i) {
    float u;
    *random = *random * 1664525u + 1013904223u;
    u = spread * ((float)(*random >> 8) * 1.1920929e-07f - 1.0f);
    obs[i] = row == 0 ? NAME_example_obs[i] : DRAWN;
  }
}
)";

// Whole millimetres, far from where rounding turns.
inline constexpr const char* kDrawPoints = R"(
enum { NAME_test_points = TEST_POINTS };
static void NAME_draw_points(uint32_t *random, float *pointsDRAW_PARAMETER) {
  int i;
  for (i = 0; i < 3 * NAME_test_points; ++i) {
    *random = *random * 1664525u + 1013904223u;
    points[i] = NAME_origin[i % 3] + 0.001f * (float)((int32_t)((*random >> 8) % SPANu) - REACH);
DRAW_LINE  }
}
)";

// What is no cloud is refused: a point that is not finite, none at all.
inline constexpr const char* kRefusePoints = R"(  points[NAME_test_points * 3 - 1] = huge * huge;
  CALL;
  if (action[0] == action[0]) return 3;
  points[NAME_test_points * 3 - 1] = 0.0f;
  NO_POINTS;
  if (action[0] == action[0]) return 3;
)";

inline constexpr const char* kRefuseClasses = R"(  point_class[0] = CLASSES;
  CALL;
  if (action[0] == action[0]) return 3;
  point_class[0] = 0;
)";

inline constexpr const char* kTestMain = R"(
int main(void) {
  static float obs[NAME_obs_dim], action[NAME_action_dim];
CLOUD  const float tolerance = TOLERANCE, huge = 3e38f;
  uint32_t sum = 2166136261u, random = 1;
  int row, i;
SUMS  if (sum != CHECKSUM) return 2;
  for (row = 0; row < ROWS; ++row) {
    if (row == 1) random = 1;
    NAME_draw(row, &random, obs);
DRAW    CALL;
    for (i = 0; i < NAME_action_dim; ++i) {
      const float gap = action[i] - NAME_expected[row * NAME_action_dim + i];
      if (!(gap <= tolerance && gap >= -tolerance)) return 1;
    }
  }
REFUSED  obs[NAME_obs_dim - 1] = huge * huge;
  for (row = 0; row < 2; ++row) {
    CALL;
    for (i = 0; i < NAME_action_dim; ++i)
      if (action[i] == action[i]) return 3;
    obs[NAME_obs_dim - 1] -= obs[NAME_obs_dim - 1];
  }
  return 0;
}
#endif
#endif
)";

}  // namespace tool
