# shellcheck shell=bash
# Sourced by the scripts of this folder: Debian packages on demand, and the words to stop with.
# shellcheck disable=SC2034
library_packages="g++ cmake ninja-build pkg-config libode-dev libccd-dev libeigen3-dev liboctomap-dev"
tool_packages="libcli11-dev nlohmann-json3-dev libpng-dev libqhull-dev"
import_packages="libtinyxml2-dev libtomlplusplus-dev"
build_packages="$library_packages $tool_packages $import_packages"
viewer_packages="libjs-three"  # what `redman render --html` puts into its pages

die() {
  echo "$(basename "$0"): $*" >&2
  exit 1
}

# missing PACKAGE...: those that are not installed; none on a system that is not Debian, where they are taken to be there.
missing() {
  local package
  command -v dpkg-query > /dev/null || return 0
  for package in "$@"; do
    dpkg-query -W -f '${Status}\n' "$package" 2> /dev/null | grep -q '^install ok installed' || printf ' %s' "$package"
  done
}

# can_install: whether there is root, or a sudo that asks nothing (or a person at a terminal whom it may ask).
can_install() {
  [ "$(id -u)" -eq 0 ] || { command -v sudo > /dev/null && { [ -t 0 ] || sudo -n true 2> /dev/null; }; }
}

# need PACKAGE...: installs what is missing, as root or through sudo, without questions.
need() {
  local missing log as_root=()
  missing=$(missing "$@")
  [ -n "$missing" ] || return 0
  can_install || die "these packages are missing, and there is neither root nor sudo to install them:$missing"
  if [ "$(id -u)" -ne 0 ]; then
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

# want LOSS PACKAGE...: the same of what a build or its tests can do without; else it says what is lost.
want() {
  local loss=$1 missing
  shift
  missing=$(missing "$@")
  [ -n "$missing" ] || return 0
  # shellcheck disable=SC2086
  can_install && (need $missing) && return
  echo "not here:$missing. Without: $loss" >&2
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
