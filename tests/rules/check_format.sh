#!/bin/sh
# Sources are as clang-format leaves them. Arguments: the project's root and clang-format. The C headers
# keep their hand-made columns; their owners in C++ have as many (include/.clang-format).
cd "$1" || exit 1
find lib tasks algos capi tests examples include \( -name '*.c' -o -name '*.cpp' -o -name '*.hpp' -o -name '*.inl' \) -print0 |
  xargs -0 "$2" --dry-run -Werror
