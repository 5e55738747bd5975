/* Prints the names of the algorithms, one a line: what tests over all of them loop over. */
#include <redman/redman.h>
#include <stdio.h>

int main(void) {
  for (int32_t i = 0; i < rdm_algo_count(); ++i) {
    rdm_algo algo = {.struct_size = sizeof algo};
    if (rdm_algo_at(i, &algo) != RDM_OK) return 1;
    puts(algo.name);
  }
  return 0;
}
