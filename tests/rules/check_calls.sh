#!/bin/sh
# Our objects call nothing that ends the process, prints, or changes what belongs to the whole process, and no
# function of the mathematics library whose last bits differ from one such library to the next:
# lib/base/elementary.hpp has ours.
# Arguments: the build type, then the static library.
set -u
type=$1 library=$2
bad='exit|_exit|_Exit|quick_exit|abort|printf|__printf_chk|puts|putchar|putc|perror|fprintf|__fprintf_chk|vprintf|vfprintf|fputs|fputc|fwrite|stdout|stderr|_ZSt4cout|_ZSt4cerr|_ZSt4clog|rand|srand|random|srandom|drand48|srand48|setlocale|strtok|strtod|strtof|signal|sigaction|raise|kill|system|getenv|setenv|dCloseODE|dRandSetSeed'
bad="$bad|(sin|cos|tan|sincos|a(sin|cos|tan)h?|atan2|sinh|cosh|tanh|exp|exp2|exp10|expm1|log|log2|log10|log1p|pow|cbrt|hypot|erfc?|[lt]gamma)[fl]?"
# Assertions stand in builds with assertions alone.
case $type in Release | MinSizeRel) bad="$bad|__assert_fail" ;; esac
found=$(nm -A -u "$library" 2> /dev/null | awk -v bad="^($bad)\$" '{ sub(/@.*/, "", $NF); if ($NF ~ bad) print $1, $NF }')
[ -z "$found" ] || { echo "$found"; exit 1; }
