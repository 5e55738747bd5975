/* What a process has taken at most, from Linux: resident memory, kB; -1 elsewhere. */
#ifndef PEAK_H
#define PEAK_H
#include <stdio.h>

static long peak_kb(void) {
  char line[128];
  long kb = -1;
  FILE* status = fopen("/proc/self/status", "r");
  while (status && fgets(line, sizeof line, status))
    if (sscanf(line, "VmHWM: %ld", &kb) == 1) break;
  if (status) fclose(status);
  return kb;
}
#endif
