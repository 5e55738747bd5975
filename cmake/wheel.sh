#!/usr/bin/env bash
# wheel.sh [BUILD FOLDER] [OUT]: a wheel of capi/python that carries the libraries, the tool and the policies of a build, and the
# libraries these need beyond glibc and the C++ runtime, found beside them ($ORIGIN) under names of their own, as auditwheel has
# them. Default: build/release, build/wheel. It installs nothing: it says what it lacks.
set -eu
cd "$(dirname "$0")/.."
. cmake/packages.sh
build=${1:-build/release}
out=${2:-build/wheel}
lacks='' python=''
for command in patchelf readelf objdump strip; do
  command -v $command > /dev/null || lacks+=" $command"
done
for each in python3 /usr/bin/python3; do
  if [ -z "$python" ] && $each -c 'import setuptools, wheel, pip' 2> /dev/null; then python=$each; fi
done
[ -n "$python" ] || lacks+=" a python3 with pip, setuptools and wheel"
[ -z "$lacks" ] || die "missing:$lacks. On Debian: apt-get install patchelf binutils python3-pip python3-setuptools python3-wheel"
[ -e "$build/libredman.so" ] || die "$build has no libredman.so: cmake --preset release && cmake --build --preset release"

stage=$(mktemp -d)
trap 'rm -rf "$stage"' EXIT
cp -r capi/python/. "$stage"
cp LICENSE "$stage"
module=$stage/redman
find "$module" -name __pycache__ -prune -exec rm -r {} +
# The package is laid out as a prefix is: there the tool looks for policies.
mkdir -p "$module/bin" "$module/share/redman"
cp -r examples/policies "$module/share/redman/policies"

# What every Linux has: the list of the manylinux policies, as far as we come near it.
given='^(ld-linux-.*|linux-vdso|libc|libm|libdl|librt|libpthread|libgcc_s|libstdc\+\+)\.so'
bundled=0
# The terms of the package that a library came with.
terms() {
  local file package
  file=$(realpath "$1")  # which packages older than the merger of /usr name without it
  package=$({ dpkg -S "$file" || dpkg -S "${file#/usr}"; } 2> /dev/null | sed 's/:.*//')
  [ -f "/usr/share/doc/$package/copyright" ] || die "$1 is of no Debian package: what are its terms?"
  echo "/usr/share/doc/$package/copyright"
}
# And of those whose sources are compiled in.
for package in libeigen3-dev libcli11-dev nlohmann-json3-dev libtomlplusplus-dev libjs-three; do
  if [ -f /usr/share/doc/$package/copyright ]; then cp -L /usr/share/doc/$package/copyright "$stage/LICENSE.${package%-dev}"; fi
done
# carry FILE BUILT [UP]: the libraries that FILE needs, and theirs, copied beside the package's own and renamed after their
# contents. BUILT is what the build has for it, UP the way from its folder to the libraries.
carry() {
  local file=$1 built=$2 up=${3:-} name path new
  for name in $(readelf -d "$file" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p'); do
    if [[ $name =~ $given || -e $module/$name ]]; then continue; fi
    path=$(LD_LIBRARY_PATH=$module ldd "$built" | awk -v name="$name" '$1 == name { print $3 }')
    [ -f "$path" ] || die "$name, which $(basename "$file") needs, is not found"
    new=${name%%.so*}-redman-$(sha256sum "$path" | cut -c1-8).so${name#*.so}
    if [ ! -e "$module/$new" ]; then
      cp -L "$path" "$module/$new"
      chmod 644 "$module/$new"
      patchelf --set-soname "$new" "$module/$new"
      cp "$(terms "$path")" "$stage/LICENSE.${name%%.so*}"
      bundled=$((bundled + 1))
      carry "$module/$new" "$built"
    fi
    patchelf --replace-needed "$name" "$new" "$file"
  done
  patchelf --set-rpath "\$ORIGIN$up" "$file"
}
# put BUILT FOLDER [UP]: a library or program of the build, in a folder of the package, with what it needs.
put() {
  local built=$build/$1 file
  [ -e "$built" ] || { echo "$build has no $1: the wheel comes without it" >&2 && return; }
  file=$module/$2/$(soname "$built")
  install -m 755 "$built" "$file"
  strip --strip-unneeded "$file"  # not after patchelf, which strip does not understand
  carry "$file" "$built" "${3:-}"
}
soname() {
  local name
  name=$(readelf -d "$1" | sed -n 's/.*(SONAME).*\[\(.*\)\]/\1/p')
  echo "${name:-$(basename "$1")}"
}
put libredman.so .
put libredman_import.so .
put bin/redman bin /..

# The oldest glibc that it runs on gives the tag, or the one that came with as old a C++ runtime (the manylinux policies).
newest() {
  find "$module" \( -name '*.so*' -o -path '*/bin/*' \) -exec objdump -T {} + | grep -o "$1[0-9]*" | sort -uV | tail -n1 | sed 's/.*\.//'
}
glibc=$(newest GLIBC_2.) runtime=$(newest GLIBCXX_3.4.)
case $runtime in
  ? | 1? | 2[0-8]) oldest=28 ;;
  29) oldest=34 ;;
  30) oldest=35 ;;
  3[12]) oldest=38 ;;
  *) oldest=39 ;;
esac
[ "$glibc" -gt "$oldest" ] && oldest=$glibc
tag=manylinux_2_${oldest}_$(uname -m)
mkdir -p "$out"
rm -f "$out"/redman-*.whl
SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct 2> /dev/null || date +%s)} $python -m pip wheel --quiet --no-index --no-deps \
  --no-build-isolation --config-settings="--build-option=--plat-name=$tag" --wheel-dir "$out" "$stage" >&2 || die "pip made no wheel: see above"
wheel=$(ls "$out"/redman-*.whl)
echo "$wheel: $(stat -c %s "$wheel") bytes, $bundled libraries carried, GLIBC_2.$glibc, GLIBCXX_3.4.$runtime" >&2
echo "$wheel"
