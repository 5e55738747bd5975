#!/bin/sh
# Sources are as clang-format leaves them. Arguments: the project's root and clang-format. The C header
# keeps its hand-made columns.
cd "$1" || exit 1
find lib tasks algos capi tests examples include \( -name '*.c' -o -name '*.cpp' -o -name '*.hpp' -o -name '*.inl' \) -print0 |
  xargs -0 "$2" --dry-run -Werror
