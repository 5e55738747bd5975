# shellcheck shell=bash
# Sourced by the scripts of this folder: Debian packages on demand, and the words to stop with.
# shellcheck disable=SC2034
build_packages="g++ cmake ninja-build pkg-config libode-dev libccd-dev libeigen3-dev liboctomap-dev
                libcli11-dev nlohmann-json3-dev libpng-dev libqhull-dev libtinyxml2-dev libtomlplusplus-dev"
viewer_packages="libjs-three"  # what `redman render --html` puts into its pages

die() {
  echo "$(basename "$0"): $*" >&2
  exit 1
}

# need PACKAGE...: installs what is missing, as root or through sudo, without questions.
need() {
  local missing="" package log as_root=()
  if ! command -v dpkg-query > /dev/null; then
    echo "not a Debian system: taking it that these are here: $*" | tr -s ' \n' ' ' >&2
    echo >&2
    return
  fi
  for package in "$@"; do
    dpkg-query -W -f '${Status}\n' "$package" 2> /dev/null | grep -q '^install ok installed' || missing+=" $package"
  done
  [ -n "$missing" ] || return 0
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo > /dev/null || die "these packages are missing, and there is no sudo to install them:$missing"
    as_root=(sudo)
    [ -t 0 ] || as_root+=(-n)
  fi
  as_root+=(env DEBIAN_FRONTEND=noninteractive apt-get -qq)
  echo "installing:$missing" >&2
  log=$(mktemp)
  # shellcheck disable=SC2086
  if ! "${as_root[@]}" install -y --no-install-recommends $missing > "$log" 2>&1 < /dev/null; then
    # Package lists may be missing or old.
    { "${as_root[@]}" update && "${as_root[@]}" install -y --no-install-recommends $missing; } > "$log" 2>&1 < /dev/null ||
      die "cannot install$missing: $(grep -m1 -E '^E: |^sudo: ' "$log" || tail -n1 "$log")"
  fi
  rm -f "$log"
}

# want PACKAGE...: the same of what a build can do without.
want() {
  (need "$@") || echo "going on without: $*" >&2
}

# configure PRESET [options...]; build PRESET: quiet unless they fail.
configure() {
  local preset=$1 log=build/configure.log
  shift
  mkdir -p build
  command -v ccache > /dev/null && set -- -DCMAKE_C_COMPILER_LAUNCHER=ccache -DCMAKE_CXX_COMPILER_LAUNCHER=ccache "$@"
  cmake --preset "$preset" "$@" > "$log" 2>&1 || { cat "$log" >&2; die "preset $preset could not be configured: see above"; }
  grep -h '^-- redman ' "$log" | sed 's/^-- //' >&2
}
build() {
  cmake --build --preset "$1" -j "$(nproc)" >&2 || die "preset $1 could not be built: see above"
}
