# shellcheck shell=bash
# Sourced: Debian's source archives, from the mirror that this machine's apt has, each with its SHA-256.

# name, archive below pool/main, SHA-256
debian_sources='
ode     o/ode/ode_0.16.2.orig.tar.gz                     b26aebdcb015e2d89720ef48e0cb2e8a3ca77915f89d853893e7cc861f810f22
ccd     libc/libccd/libccd_2.1.orig.tar.gz               3543093486a8bdb7129e18d69d8f2b42e3056877521425210f9fe560789ebba5
octomap o/octomap/octomap_1.10.0+dfsg.orig.tar.xz        1f217ad16e20dcf2a83965ac5d01988a9a24d3c68b5e4272aee0dda1a1b0790d
tinyxml2 t/tinyxml2/tinyxml2_9.0.0+dfsg.orig.tar.xz      96510f47a5db537f70dff3e83dd71fd2180cbba4aa76c589a549467e7f34bc9b
png     libp/libpng1.6/libpng1.6_1.6.39.orig.tar.gz      a00e9d2f2f664186e4202db9299397f851aea71b36a35e74910b8820e380d441
'

# source_of NAME: its folder, unpacked once below build/cross/sources; ends the script when it cannot be had.
source_of() {
  local row name=$1 folder=build/cross/sources archive sum mirror got
  row=$(grep "^$name " <<< "$debian_sources") || die "no source is listed for $name"
  read -r _ archive sum <<< "$row"
  if [ ! -e "$folder/$name/.whole" ]; then
    mirror=${DEBIAN_MIRROR:-$(apt-get download --print-uris libccd2 2> /dev/null | sed -n "s|^'\(.*\)/pool/.*|\1|p")}
    [ -n "$mirror" ] || die "no Debian mirror is known: set DEBIAN_MIRROR to one, http://HOST/debian"
    rm -rf "${folder:?}/$name"
    mkdir -p "$folder/$name"
    got=$folder/$(basename "$archive")
    curl -sSfL --retry 3 -o "$got" "$mirror/pool/main/$archive" >&2 || die "cannot fetch $mirror/pool/main/$archive"
    echo "$sum  $got" | sha256sum --quiet -c >&2 || die "$got is not what was published"
    tar xf "$got" -C "$folder/$name" --strip-components 1 || die "cannot unpack $got"
    : > "$folder/$name/.whole"
  fi
  echo "$PWD/$folder/$name"
}
