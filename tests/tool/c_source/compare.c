/* compare PROBE: the exported policy on the observations of `redman export --probe`, as numbers on lines of
 * their own: rows, then obs [rows][obs_dim], then action [rows][action_dim]. Prints the largest difference,
 * then how many actions are the same bytes. NAME is the prefix of the export, POLICY its file. With EYES
 * points [rows][num_points][3] come behind, which are given backwards and the first one twice, with KINDS
 * point_class, and with COLORS point_color. With STATE the rows are an episode of a policy with a memory. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#define REDMAN_POLICY_HEADER
#include POLICY
#define JOIN(a, b) a##b
#define SYMBOL(name, part) JOIN(name, part)

static float* numbers(FILE* f, size_t count) {
  float* x = (float*)malloc(count * sizeof *x);
  for (size_t i = 0; x && i < count; ++i) {
    double v;
    if (fscanf(f, "%lf", &v) != 1) exit(2);
    x[i] = (float)v;
  }
  return x;
}

int main(int argc, char** argv) {
  const size_t in = SYMBOL(NAME, _obs_dim), out = SYMBOL(NAME, _action_dim);
  FILE* f = argc > 1 ? fopen(argv[1], "r") : NULL;
  size_t rows = 0, same = 0;
  float action[SYMBOL(NAME, _action_dim)], largest = 0;
#ifdef STATE
  static float state[SYMBOL(NAME, _state_size)];
#endif
  if (!f || fscanf(f, "%zu", &rows) != 1) return 2;
  float *obs = numbers(f, rows * in), *want = numbers(f, rows * out);
#ifdef EYES
  const size_t count = SYMBOL(NAME, _num_points);
  float *points = numbers(f, rows * count * 3), *cloud = (float*)malloc((count + 1) * 3 * sizeof *cloud);
  if (!points || !cloud) return 2;
#ifdef KINDS
  float* classes = numbers(f, rows * count);
  unsigned char* kinds = (unsigned char*)malloc(count + 1);
  if (!classes || !kinds) return 2;
#endif
#ifdef COLORS
  float* colors = numbers(f, rows * count * 3);
  unsigned char* tints = (unsigned char*)malloc(3 * (count + 1));
  if (!colors || !tints) return 2;
#endif
#endif
  fclose(f);
  if (!obs || !want) return 2;
#ifdef STATE
#define REMEMBERED state,
#else
#define REMEMBERED
#endif
  for (size_t r = 0; r < rows; ++r) {
#ifdef EYES
    for (size_t i = 0; i <= count; ++i) {
      const size_t from = r * count + (i < count ? count - 1 - i : 0);
      memcpy(cloud + 3 * i, points + 3 * from, 3 * sizeof *points);
#ifdef KINDS
      kinds[i] = (unsigned char)classes[from];
#endif
#ifdef COLORS
      for (size_t k = 0; k < 3; ++k) tints[3 * i + k] = (unsigned char)colors[3 * from + k];
#endif
    }
#if defined COLORS
    SYMBOL(NAME, _act_points)(obs + r * in, cloud, kinds, tints, (int)count + 1, REMEMBERED action);
#elif defined KINDS
    SYMBOL(NAME, _act_points)(obs + r * in, cloud, kinds, (int)count + 1, REMEMBERED action);
#else
    SYMBOL(NAME, _act_points)(obs + r * in, cloud, (int)count + 1, REMEMBERED action);
#endif
#else
    SYMBOL(NAME, _act)(obs + r * in, REMEMBERED action);
#endif
    for (size_t j = 0; j < out; ++j) {
      const float gap = fabsf(action[j] - want[r * out + j]);
      if (!(gap <= largest)) largest = gap; /* NaN stays */
      same += memcmp(&action[j], &want[r * out + j], sizeof action[j]) == 0;
    }
  }
  printf("%.9g %zu of %zu\n", (double)largest, same, rows * out);
  free(obs);
  free(want);
  return 0;
}
