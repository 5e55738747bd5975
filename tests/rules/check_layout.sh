#!/bin/sh
# Sizes and offsets of the public structs, as the program prints them, against the golden file. Structs grow
# at their end alone: a new line may be added to the golden file, none may change while RDM_ABI stands.
# Arguments: the program and the golden file.
set -u
found=$("$1") || exit 1
[ "$found" = "$(cat "$2")" ] || { printf '%s\n' "$found" | diff "$2" -; exit 1; }
