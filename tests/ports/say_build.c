/* Prints what the library says of its build here: kernels, then what computes other bytes ("same bytes" for
 * nothing). */
#include <redman/redman.h>
#include <stdio.h>

int main(void) {
  rdm_build build = {.struct_size = sizeof build};
  if (rdm_build_info(&build) != RDM_OK) {
    puts(rdm_last_error());
    return 1;
  }
  printf("%s; %s\n", build.kernels, build.differs[0] ? build.differs : "same bytes");
  return 0;
}
