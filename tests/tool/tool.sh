# What every test of the tool begins with, sourced as `. "$(dirname "$0")/tool.sh"`: the tool's path, the folder of
# the tests, and an empty folder of its own to work in, which goes when the test ends.
set -u
tool=$(realpath "$1")
here=$(cd "$(dirname "$0")" && pwd)
failed=0
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
cd "$dir" || exit 1
