#!/usr/bin/env bash
# Builds and runs the program of a language: languages.sh LANGUAGE POLICY [bench]
#   bash examples/languages.sh rust runs/first/policy.rdm
# LANGUAGE: c cpp rust go node lua java csharp ruby. Ends with 77 and a reason where a tool of the language is missing.
# Environment: REDMAN_LIBRARY (build/release/libredman.so), WORK (folder for what is built; build/languages),
# REDMAN_KOFFI (a node_modules folder with koffi; build/node_modules).
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
language=${1:?usage: languages.sh LANGUAGE POLICY [bench]}
shift
export REDMAN_LIBRARY=${REDMAN_LIBRARY:-$root/build/release/libredman.so} REDMAN_INCLUDE=$root/include/redman
[ -e "$REDMAN_LIBRARY" ] || { echo "languages.sh: there is no library $REDMAN_LIBRARY: build redman, or set REDMAN_LIBRARY" >&2; exit 1; }
libraries=$(cd "$(dirname "$REDMAN_LIBRARY")" && pwd)
source=$root/examples/$language
work=${WORK:-$root/build/languages}/$language
export LD_LIBRARY_PATH=$libraries${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
mkdir -p "$work"

skip() {
  echo "$language: skipped, $1 is missing: $2"
  exit 77
}
# want TOOL HOW...: TOOL can be run, else HOW to get it is the reason.
want() { command -v "$1" > /dev/null || skip "$@"; }
# Whether there is no program $1 as new as its source, the headers and the library.
stale() { [ ! "$1" -nt "$2" ] || [ -n "$(find "$REDMAN_INCLUDE" -name '*.h' -newer "$1")" ] || [ ! "$1" -nt "$REDMAN_LIBRARY" ]; }

case $language in
  c | cpp)
    hello=$work/hello compiler=${CC:-cc} flags=-std=c99 file=$source/hello.c
    [ "$language" = c ] || { compiler=${CXX:-c++} flags=-std=c++17 file=$source/hello.cpp; }
    want "$compiler" "apt-get install g++"
    stale "$hello" "$file" &&
      "$compiler" $flags -O2 -Wall -Wextra -Wpedantic -Werror -I"$root/include" "$file" -o "$hello" -L"$libraries" -lredman
    set -- "$hello" "$@"
    ;;
  rust)
    hello=$work/hello
    want rustc "apt-get install rustc"
    want bindgen "apt-get install bindgen"
    if stale "$hello" "$source/hello.rs"; then
      bindgen "$REDMAN_INCLUDE/redman.h" --size_t-is-usize --no-prepend-enum-name --allowlist-file '.*/redman/[a-z]+\.h' \
        -o "$work/redman_sys.rs" -- "-I$root/include" 2> "$work/bindgen.log" || {
        ! grep -q 'find.*libclang' "$work/bindgen.log" || skip libclang "apt-get install libclang1-14 libclang-common-14-dev"
        cat "$work/bindgen.log" >&2
        exit 1
      }
      rustc --edition 2021 -O --cap-lints allow --crate-type rlib --out-dir "$work" "$work/redman_sys.rs"
      rustc --edition 2021 -O -D warnings --extern redman_sys="$work/libredman_sys.rlib" -L "$libraries" -l redman \
        "$source/hello.rs" -o "$hello"
    fi
    set -- "$hello" "$@"
    ;;
  go)
    hello=$work/hello
    want go "apt-get install golang-go"
    export GOCACHE=${GOCACHE:-$work/cache} GOFLAGS=-mod=mod CGO_CFLAGS="-O2 -I$root/include" CGO_LDFLAGS="-L$libraries"
    stale "$hello" "$source/hello.go" && go build -o "$hello" "$source/hello.go"
    set -- "$hello" "$@"
    ;;
  node)
    want node "apt-get install nodejs"
    export NODE_PATH=${REDMAN_KOFFI:-$root/build/node_modules}
    (cd "$source" && node -e 'require("koffi")') 2> /dev/null || skip koffi "npm install koffi, and REDMAN_KOFFI is its node_modules"
    set -- node "$source/hello.js" "$@"
    ;;
  lua)
    want luajit "apt-get install luajit"
    set -- luajit "$source/hello.lua" "$@"
    ;;
  java)
    jna=/usr/share/java/jna.jar
    want javac "apt-get install default-jdk-headless"
    [ -e $jna ] || skip $jna "apt-get install libjna-java"
    set -- java -Djna.library.path="$libraries" -cp $jna "$source/Hello.java" "$@"
    ;;
  csharp)
    want mcs "apt-get install mono-mcs"
    want mono "apt-get install mono-runtime"
    stale "$work/Hello.exe" "$source/Hello.cs" && mcs -unsafe -warnaserror -optimize -out:"$work/Hello.exe" "$source/Hello.cs"
    set -- mono "$work/Hello.exe" "$@"
    ;;
  ruby)
    want ruby "apt-get install ruby"
    set -- ruby "$source/hello.rb" "$@"
    ;;
  *)
    echo "languages.sh: there is no language '$language': c cpp rust go node lua java csharp ruby" >&2
    exit 2
    ;;
esac
exec "$@"
