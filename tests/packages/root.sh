# shellcheck shell=bash
# Sourced by the tests that use packages where nothing else is: new_root NAME PACKAGE... makes build/packages/NAME, a Debian
# root with these packages and what stands in build/packages/NAME.files, in it as /packages; in_root COMMAND runs there.
set -eu
cd "$(dirname "$0")/../.."
. cmake/packages.sh
roots=$PWD/build/roots
[ "$(id -u)" -eq 0 ] || die "a root of its own needs root"

# The first Debian archive that this machine's apt reads, and its release.
archive() {
  apt-get indextargets --format '$(REPO_URI) $(CODENAME)' 'Created-By: Packages' 'Origin: Debian' | head -n1
}

base_root() {
  local uri codename
  [ ! -e "$roots/base.done" ] || return 0
  need debootstrap
  read -r uri codename <<< "$(archive)"
  [ -n "$uri" ] || die "apt knows no Debian archive: run apt-get update"
  rm -rf "$roots/base"
  mkdir -p "$roots"
  echo "a base system of $codename" >&2
  debootstrap --variant=minbase "$codename" "$roots/base" "$uri" > "$roots/base.log" 2>&1 ||
    { tail -n5 "$roots/base.log" >&2; die "debootstrap failed: $roots/base.log"; }
  touch "$roots/base.done"
}

# new_root NAME FILE... -- PACKAGE...
new_root() {
  local name=$1 files=()
  shift
  while [ "$1" != -- ]; do files+=("$1"); shift; done
  shift
  base_root
  root=$roots/$name
  rm -rf "$root"
  cp -a "$roots/base" "$root"
  cp -L /etc/resolv.conf "$root/etc/resolv.conf"
  mkdir "$root/packages"
  cp "${files[@]}" "$root/packages"
  in_root "export DEBIAN_FRONTEND=noninteractive; apt-get -qq update && apt-get -qq install -y --no-install-recommends $*" \
    > "$roots/$name.log" 2>&1 || { tail -n5 "$roots/$name.log" >&2; die "apt could not install in $name: $roots/$name.log"; }
}

# With a /proc, by which a program finds what lies beside it; it goes with the command.
in_root() {
  # shellcheck disable=SC2016
  unshare --mount sh -ec 'mount -t proc proc "$1/proc"
    exec chroot "$1" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 sh -ec "$2"' in_root "$root" "$1"
}

# The first block of code in this language in a page.
block() {
  awk -v open='```'"$1" '$0 == open && !done { on = 1; next } /^```/ { if (on) done = 1; on = 0 } on' "$2"
}

passed=0 failed=0
# check WHAT COMMAND...: the command's last lines are shown.
check() {
  local what=$1 out
  shift
  if out=$("$@" 2>&1); then
    passed=$((passed + 1))
    echo "good: $what: $(printf '%s' "$out" | tail -n2 | cut -c1-100 | tr '\n' ' ')"
  else
    failed=$((failed + 1))
    printf 'BAD: %s:\n%s\n' "$what" "$(printf '%s' "$out" | tail -n20)"
  fi
}
finish() {
  echo "$passed passed, $failed failed"
  [ "$failed" -eq 0 ]
}
