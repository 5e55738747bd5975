#!/bin/sh
# neon.sh ARCHIVE OBJDUMP: the compiler made the kernels of stepper and networks of four lanes of NEON (those of one lane stand beside them).
set -u
"$2" -d "$1" | awk '
  /file format/ { file = $1 }
  /\tf(mul|add|sub|div)\t[sd][0-9]+,/ { ++one[file] }
  /\tf(mul|add|sub|div)\tv[0-9]+\.4s/ { ++four[file] }
  END {
    split("stepper_v2.cpp.o: kernels_v2.cpp.o:", wanted, " ")
    for (i in wanted) {
      file = wanted[i]
      if (four[file] > 500) ++passed; else ++failed
      printf "%s %d instructions of four lanes, %d of one\n", file, four[file], one[file]
    }
    print passed + 0 " passed, " failed + 0 " failed"
    exit failed > 0
  }'
