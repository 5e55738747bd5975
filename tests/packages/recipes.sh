#!/bin/sh
# recipes.sh ROOT: the versions that recipes, changelogs and CITATION.cff name are the header's, and vcpkg.json and conanfile.py can be read.
set -u
root=$1
status=0
wrong() { echo "$*"; status=1; }
part() { sed -n "s/^#define RDM_VERSION_$1 \([0-9]*\).*/\1/p" "$root/include/redman/base.h"; }
version=$(part MAJOR).$(part MINOR).$(part PATCH)
packaging=$root/cmake/packaging
grep -q "\"version\": \"$version\"" "$packaging/vcpkg/vcpkg.json" || wrong "vcpkg.json has another version than $version"
head -n1 "$packaging/debian/changelog" | grep -qF "($version)" || wrong "debian/changelog begins with another version than $version"
released=$(sed -n "s/^## \[$version\] - //p" "$root/CHANGELOG.md")
[ -n "$released" ] || wrong "CHANGELOG.md has no section of version $version"
grep -qxF "version: $version" "$root/CITATION.cff" || wrong "CITATION.cff has another version than $version"
grep -qxF "date-released: $released" "$root/CITATION.cff" || wrong "CITATION.cff has another date than CHANGELOG.md, $released"
# Every -D of the recipes is an option that the build has.
for name in $(grep -ohE 'REDMAN_[A-Z]+' "$packaging/vcpkg/portfile.cmake" "$packaging/conan/conanfile.py" | sort -u); do
  grep -qE "(option|set)\($name " "$root/CMakeLists.txt" || wrong "the recipes set $name, which the build does not know"
done
python3=$(command -v python3) || { echo "no python3: the recipes were not read"; exit $status; }
"$python3" - "$packaging" << 'END' || status=1
import ast, json, sys
from pathlib import Path
packaging = Path(sys.argv[1])
port = json.loads((packaging / "vcpkg/vcpkg.json").read_text())
for name in port["default-features"]:
    assert name in port["features"], f"vcpkg.json: no feature {name}"
portfile = (packaging / "vcpkg/portfile.cmake").read_text()
for name in port["features"]:
    assert f"\n  {name} REDMAN_" in portfile, f"portfile.cmake: feature {name} sets nothing"
for recipe in packaging.glob("conan/**/conanfile.py"):
    ast.parse(recipe.read_text(), str(recipe))
END
exit $status
