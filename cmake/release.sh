#!/usr/bin/env bash
# release.sh [MODE...]: what `check.sh release` runs: the modes of check.sh, all of them unless some are given, in a clean copy of
# the commit. Then it makes the files to publish, and writes one page: what passed, on which machine, in what time, and the hash of
# each file. It can be stopped and called again: a mode that has passed for this commit is not run again. Nor is one that has a row
# in examples/results/release.csv, also from another machine, if nothing that the mode looks at has changed since the row's commit;
# modes that read any document need a row of this commit.
#   build/published/COMMIT/README.md   the page         build/published/COMMIT/MODE.log   what a mode said
#   build/published/COMMIT/files/      source archive, .deb files, wheel, policies, SHA256SUMS
#   build/published/COMMIT/release.csv the rows, to be copied to examples/results and committed
# The exit status is 0 when every mode has passed and every file is there.
set -u
cd "$(dirname "$0")/.." || exit 1
die() { echo "release.sh: $*" >&2; exit 1; }
all=$(bash cmake/check.sh --help | awk 'NR > 1 { print $1 }' | grep -vx release)
modes=${*:-$all}
for mode in $modes; do echo "$all" | grep -qxF -- "$mode" || die "check.sh has no mode '$mode' for a release"; done
[ -z "$(git status --porcelain)" ] || die "the tree has changes: commit them first"
commit=$(git rev-parse HEAD) short=$(git rev-parse --short=12 HEAD)
version=$(sed -n 's/^#define RDM_VERSION_[A-Z]* \([0-9]*\)$/\1/p' include/redman/base.h | paste -sd.)
out=$PWD/build/published/$short files=$PWD/build/published/$short/files copy=$PWD/build/published/tree
rows=$out/release.csv kept=examples/results/release.csv
columns='mode,commit,passed,failed,seconds,day,machine'
machine="$(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n1), $(nproc) processors, $(awk '/MemTotal/ { printf "%.0f GiB", $2 / 1048576 }' /proc/meminfo)"
mkdir -p "$files"
[ -d "$copy/.git" ] || git clone -q . "$copy" || die "cannot copy the tree"
# builds stay, so that the next commit is not from nothing; nothing else does
git -C "$copy" fetch -q "$PWD" HEAD || die "cannot fetch $commit"
{ git -C "$copy" checkout -q -f "$commit" && git -C "$copy" clean -qfd; } || die "cannot check out $commit"

# holds COMMIT MODE: what passed at that commit still does, since nothing that the mode looks at has changed. The page for a browser,
# the list of tests under valgrind and the script of small programs are read by their own modes alone, what the library costs by `budget`
# beside quick and dev, and this script by none. Of the documents `small` and `physics` read one each, with the table that they measure again.
holds() {
  case $2 in
    quick | dev | packages) [ "$1" = "$commit" ]; return ;;
    small) git diff --quiet "$1" "$commit" -- examples/small/README.md 2> /dev/null || return ;;
    physics) git diff --quiet "$1" "$commit" -- lib/physics/README.md 2> /dev/null || return ;;
  esac
  local unread=(':!*.md' ':!examples/results' ':!examples/pictures' ':!cmake/release.sh')
  [ "$2" = browser ] || unread+=(':!examples/browser')
  [ "$2" = valgrind ] || unread+=(':!tests/valgrind.cmake')
  [ "$2" = small ] || unread+=(':!cmake/small_table.sh')
  [ "$2" = budget ] || unread+=(':!cmake/budget.*')
  git diff --quiet "$1" "$commit" -- . "${unread[@]}" 2> /dev/null
}

# row MODE: its newest row that holds, of this folder or of the tree; fails where there is none.
row() {
  local line
  while IFS= read -r line; do
    if holds "$(cut -d, -f2 <<< "$line")" "$1"; then echo "$line"; return; fi
  done < <(cat "$kept" "$rows" 2> /dev/null | grep "^$1," | tac)
  return 1
}

for mode in $modes; do
  if row "$mode" > /dev/null; then continue; fi
  start=$(date +%s)
  more=$([ "$mode" != arm64 ] || echo all)
  # shellcheck disable=SC2086
  (cd "$copy" && bash cmake/check.sh "$mode" $more) > "$out/$mode.log" 2>&1 < /dev/null
  status=$?
  seconds=$(($(date +%s) - start))
  counts=$(sed -n 's/^\([0-9]*\) passed, \([0-9]*\) failed$/\1,\2/p' "$out/$mode.log" | tail -n1)
  rm -f "$out/$mode.failed"
  if [ $status -eq 0 ]; then
    echo "$mode,$commit,${counts:-,},$seconds,$(date -u +%F),\"$machine\"" >> "$rows"
  else
    echo "$mode,$commit,${counts:-,},$seconds,$(date -u +%F),\"$machine\"" > "$out/$mode.failed"
  fi
  echo "$mode: $([ $status -eq 0 ] && echo passed || echo "failed, see $out/$mode.log"), $seconds s" >&2
done

# ---- files
lost=0
git archive --format=tar --prefix="redman-$version/" "$commit" | gzip -9n > "$files/redman-$version.tar.gz"
git -C examples/policies archive --format=tar --prefix="redman-policies-$version/" "$commit" | gzip -9n > "$files/redman-policies-$version.tar.gz"
# of mode packages, once it has passed for this commit: builds of an earlier one stay in the copy
if grep -qs "^packages,$commit," "$rows" && ! ls "$files"/*.whl > /dev/null 2>&1; then
  cp "$copy"/build/package/packages/*.deb "$copy"/build/wheel/*.whl "$files"
fi
ls "$files"/*.deb > /dev/null 2>&1 && ls "$files"/*.whl > /dev/null 2>&1 || lost=1
(cd "$files" && find . -type f ! -name SHA256SUMS -printf '%P\n' | sort | xargs sha256sum > SHA256SUMS)

# ---- the page
good=0 number=0 sum=0 table='' list=''
for mode in $all; do
  what=$(bash cmake/check.sh --markdown | awk -F' [|] |^[|] ' -v mode="$mode" '{ name = $2; gsub(/`/, "", name); sub(/ .*/, "", name) } name == mode { print $3 }')
  line='' passed='' failed='' seconds='' day='' at='' verdict='not run'
  if line=$(row "$mode"); then
    verdict=passed good=$((good + 1)) list+="$line"$'\n'
  elif [ -s "$out/$mode.failed" ]; then
    verdict=FAILED line=$(cat "$out/$mode.failed")
  fi
  IFS=, read -r _ at passed failed seconds day _ <<< "$line"
  number=$((number + 1)) sum=$((sum + ${seconds:-0}))
  table+="| \`$mode\` | $what | $verdict${passed:+: $passed passed, $failed failed} | ${seconds:+$((seconds / 60)) min $((seconds % 60)) s} | ${day:--} | ${at:+\`${at:0:8}\`} |"$'\n'
done
{ echo "$columns"; printf '%s' "$list"; } > "$rows.new" && mv "$rows.new" "$rows"
{
  echo "# redman $version"
  echo
  echo "$good of $number jobs passed, in $((sum / 3600)) h $((sum / 60 % 60)) min, builds included. Commit \`$commit\`; a job with another commit ran there, and nothing that it looks at has changed since: documents have, examples/browser, which \`browser\` alone builds, tests/valgrind.cmake, which \`valgrind\` alone reads, cmake/small_table.sh, which \`small\` alone runs, or cmake/budget.*, which \`budget\` reads beside \`quick\` and \`dev\`."
  echo
  echo "$(. /etc/os-release && echo "$PRETTY_NAME"); $(c++ --version | head -n1). Machines:"
  echo
  sed -n 's/.*,"\(.*\)"$/- \1/p' "$rows" | sort -u
  echo
  echo "| \`check.sh\` | what it asks | result | time | day | commit |"
  echo "|---|---|---|---|---|---|"
  printf '%s' "$table"
  echo
  echo "| file | bytes | SHA-256 |"
  echo "|---|---|---|"
  while read -r hash file; do echo "| \`$file\` | $(stat -c %s "$files/$file") | \`$hash\` |"; done < "$files/SHA256SUMS"
  [ $lost -eq 0 ] || { echo; echo "The .deb files or the wheel are missing: mode \`packages\` makes them."; }
} > "$out/README.md"
echo "$out/README.md"
[ $good -eq $number ] && [ $lost -eq 0 ]
