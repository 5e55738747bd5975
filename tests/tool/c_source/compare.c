/* compare PROBE: the exported policy on the observations of `redman export --probe`, as numbers on lines of
 * their own: rows, then obs [rows][obs_dim], then action [rows][action_dim]. Prints the largest difference,
 * then how many actions are the same bytes. NAME is the prefix of the export, POLICY its file. */
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
  if (!f || fscanf(f, "%zu", &rows) != 1) return 2;
  float *obs = numbers(f, rows * in), *want = numbers(f, rows * out);
  fclose(f);
  if (!obs || !want) return 2;
  for (size_t r = 0; r < rows; ++r) {
    SYMBOL(NAME, _act)(obs + r * in, action);
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
