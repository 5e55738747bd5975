#!/usr/bin/env bash
# wheel.sh [BUILD FOLDER] [OUT]: a wheel of capi/python that carries the shared library and those it needs beyond glibc and the
# C++ runtime, found beside it ($ORIGIN) under names of their own, as auditwheel has them. Default: build/release, build/wheel.
set -eu
cd "$(dirname "$0")/.."
. cmake/packages.sh
build=${1:-build/release}
out=${2:-build/wheel}
need patchelf binutils python3-pip python3-setuptools python3-wheel
[ -e "$build/libredman.so" ] || die "$build has no libredman.so: cmake --preset release && cmake --build --preset release"
python=/usr/bin/python3
[ -x $python ] || python=python3

stage=$(mktemp -d)
trap 'rm -rf "$stage"' EXIT
cp -r capi/python/. "$stage"
cp LICENSE "$stage"
module=$stage/redman
find "$module" -name __pycache__ -prune -exec rm -r {} +
soname=$(readelf -d "$build/libredman.so" | sed -n 's/.*(SONAME).*\[\(.*\)\]/\1/p')
cp -L "$build/libredman.so" "$module/$soname"
cp -r examples/policies "$module/policies"
strip --strip-unneeded "$module/$soname"  # not after patchelf, which strip does not understand

# What every Linux has: the list of the manylinux policies, as far as we come near it.
given='^(ld-linux-.*|linux-vdso|libc|libm|libdl|librt|libpthread|libgcc_s|libstdc\+\+)\.so'
bundled=0
# The terms of the package that a library came with.
terms() {
  local package
  package=$(dpkg -S "$(realpath "$1")" 2> /dev/null | sed 's/:.*//')
  [ -f "/usr/share/doc/$package/copyright" ] || die "$1 is of no Debian package: what are its terms?"
  echo "/usr/share/doc/$package/copyright"
}
# carry FILE: the libraries that FILE needs, and theirs, copied beside it and renamed after their contents.
carry() {
  local file=$1 name path new
  for name in $(readelf -d "$file" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p'); do
    if [[ $name =~ $given || $name == *-redman-* ]]; then continue; fi
    path=$(LD_LIBRARY_PATH=$module ldd "$build/libredman.so" | awk -v name="$name" '$1 == name { print $3 }')
    [ -f "$path" ] || die "$name, which $(basename "$file") needs, is not found"
    new=${name%%.so*}-redman-$(sha256sum "$path" | cut -c1-8).so${name#*.so}
    if [ ! -e "$module/$new" ]; then
      cp -L "$path" "$module/$new"
      chmod 644 "$module/$new"
      patchelf --set-soname "$new" "$module/$new"
      cp "$(terms "$path")" "$stage/LICENSE.${name%%.so*}"
      bundled=$((bundled + 1))
      carry "$module/$new"
    fi
    patchelf --replace-needed "$name" "$new" "$file"
  done
  patchelf --set-rpath '$ORIGIN' "$file"
}
carry "$module/$soname"

# The oldest glibc that it runs on gives the tag, or the one that came with as old a C++ runtime (the manylinux policies).
newest() {
  for file in "$module"/*.so*; do objdump -T "$file"; done | grep -o "$1[0-9]*" | sort -uV | tail -n1 | sed 's/.*\.//'
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
