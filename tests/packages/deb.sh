#!/usr/bin/env bash
# deb.sh FOLDER TOOL: the .deb files of FOLDER installed in a Debian root that has nothing else of ours, and used there
# as README says: its C program, its Python lines, the tool, the manual. TOOL is the built one, for the same hash.
. "$(dirname "$0")/root.sh"
folder=$1 tool=$2
block c README.md > build/hello.c
block python README.md > build/hello.py
[ -s build/hello.py ] || die "README.md has no Python lines"
new_root deb "$folder"/*.deb build/hello.c build/hello.py examples/scenes/press.task -- /packages/*.deb gcc libc6-dev pkg-config man-db

episode="rollout --task hand_over_safe_finger --policy hold --episodes 1 --seed 7 --out /tmp/steps.csv --json"
hash_here() {
  # shellcheck disable=SC2086
  "$tool" $episode | sed 's/.*"hash":"\([^"]*\)".*/\1/'
}
line=$(grep -o '^`cc hello.c [^`]*`' README.md | tr -d '`')
check "README's C program by README's line" in_root "cd /packages; $line; ./a.out | grep '^return'"
check "README's Python lines" in_root 'cd /tmp; python3 /packages/hello.py'
check "the module is the package's" in_root 'cd /tmp; python3 -c "import redman; print(redman.__file__)" | grep ^/usr/lib/python3/dist-packages/'
check "Python reads a .task file" in_root 'cd /tmp; python3 -c "import redman; print(redman.Pool(\"/packages/press.task\", 2))"'
check "redman tasks" in_root 'redman tasks | grep hand_over_safe_finger'
check "redman --version" in_root 'redman --version'
check "the same bytes as here" in_root "redman $episode | grep -o '$(hash_here)'"
check "man redman" in_root 'man redman | grep "hand\|dexterous"'
check "man redman-bench-step" in_root 'man redman-bench-step | grep -- --seconds'
check "bash completes" in_root 'bash -c ". /usr/share/bash-completion/completions/redman; COMP_WORDS=(redman ev); COMP_CWORD=1; _redman; echo \${COMPREPLY[0]}" | grep eval'
check "the loader's cache has the library" in_root 'ldconfig -p | grep libredman.so'
check "the manual" in_root 'grep "^# The redman manual" /usr/share/doc/redman/manual/README.md && ls /usr/share/doc/redman/manual/../examples/pictures/press.png'
check "an example of the -dev package" in_root \
  'cd /tmp; cc -std=c99 /usr/share/doc/redman/examples/01_step.c $(pkg-config --cflags --libs redman) && ./a.out'
check "all is gone after apt-get purge" in_root \
  'apt-get -qq purge -y redman redman-doc libredman-dev libredman-import1 python3-redman libredman1 > /dev/null 2>&1; rm -rf /packages /tmp/*
   left=$(find / -xdev -name "*redman*" ! -path "/proc/*" ! -path "/var/log/*" ! -path "/var/cache/*"); echo "$left"; test -z "$left"'
finish
