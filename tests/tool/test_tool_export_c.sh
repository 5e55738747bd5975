#!/bin/sh
# test_tool_export_c.sh TOOL: policies as C source, by every compiler that is here: no warning, the same actions as the
# library's on 1,000 observations, a self-test that passes and notices what is changed.
. "$(dirname "$0")/tool.sh"
say() { echo "$*"; failed=1; }
strict='-Wall -Wextra -Wpedantic -Wconversion -Wdouble-promotion -Wshadow -Wmissing-prototypes -Werror'
compilers=
for compiler in cc clang; do command -v $compiler > /dev/null && compilers="$compilers $compiler"; done
[ -n "$compilers" ] || { echo "skipped: there is no C compiler"; exit 77; }

# policy NAME FLAGS...: a small run, exported twice
policy() {
  name=$1
  shift
  "$tool" train --envs 4 --steps 512 --set max_steps=20 --set horizon=8 "$@" --out "$name" > out 2> err || { cat err; exit 1; }
  # shellcheck disable=SC2086
  "$tool" export --policy "$name/policy.rdm" --c "$name.c" --name "$name" --probe "$name.json" --probes 1000 $shield --json > "$name.out" ||
    say "$name: no export"
  # shellcheck disable=SC2086
  "$tool" export --policy "$name" --c "${name}_8.c" --name "${name}_8" --int8 $shield --json > "${name}_8.out" || say "$name: no int8 export"
  grep -q "\"file\":\"$name.c\",\"bytes\":$(stat -c %s "$name.c")," "$name.out" || say "$name: $(cat "$name.out")"
  # the numbers of the probe, one a line
  part() { sed "s/.*\"$1\":\\[*//; s/[]},].*//" "$name.json"; echo; }
  list() { sed "s/.*\"$1\":\\[//; s/\\].*//" "$name.json" | tr , '\n'; echo; }
  { part rows; list obs; list action; case $eyes in *EYES*) list points ;; esac; case $eyes in *KINDS*) list point_class ;; esac; case $eyes in *COLORS*) list point_color ;; esac; } > "$name.txt"
}
# status FILE WANT WHAT: the self-test's
status() {
  cc -std=c99 -O0 -w -DREDMAN_POLICY_TEST "$1" -o self || { say "$3: does not compile"; return; }
  ./self
  got=$?
  [ $got -eq "$2" ] || say "$3: the self-test answers $got, not $2"
}
# compared NAME LIMIT FLAGS...: the largest difference is within the limit, and all bytes are the same for 0
compared() {
  file=$1 base=${1%_8} limit=$2
  shift 2
  # shellcheck disable=SC2086
  cc -std=c99 "$@" $eyes "-DNAME=$file" "-DPOLICY=\"$dir/$file.c\"" "$here/c_source/compare.c" "$file.c" -o compare -lm &&
    ./compare "$base.txt" > found || { say "$file: nothing was compared"; return; }
  awk -v limit="$limit" '{ exit !($1 <= limit) }' found || say "$file $*: $(cat found), the limit is $limit"
}
stated() { sed "s/.*\"$1\":\\([0-9.e+-]*\\).*/\\1/" "$2"; }

checked=0
check() {
  policy "$@"
  name=$1
  for file in "$name.c" "${name}_8.c"; do
    for compiler in $compilers; do
      for macro in REDMAN_POLICY_TEST REDMAN_POLICY_HEADER NONE; do
        # shellcheck disable=SC2086
        $compiler -std=c99 -Os $strict -D$macro -c "$file" -o object || say "$file: $compiler warns"
      done
    done
    if command -v c++ > /dev/null; then
      for dialect in 11 20; do
        c++ -x c++ -std=c++$dialect -fsyntax-only -Wall -Wextra -Wpedantic -Wconversion -Werror -DREDMAN_POLICY_TEST "$file" ||
          say "$file: c++$dialect warns"
      done
    fi
    status "$file" 0 "$file"
    # any number that is changed is noticed, and a policy that takes what is no number
    for table in weight_0 $(case $name in bare*_gru) echo weight_input bias_state ;; bare_student) echo weight_latent_0 bias_latent_0 ;; *student | *latent) echo bias_1 weight_latent_1 ;; *) echo bias_1 ;; esac) $(case $eyes in *EYES*) echo weight_eye_0 origin ;; esac) ${shield:+low high}; do
      awk -v table="_$table[" '{ if (on) { sub(/^  -?/, "&1"); on = 0 } if (index($0, table) && /^static const/) on = 1; print }' \
        "$file" > changed.c
      cmp -s "$file" changed.c && say "$file: nothing was changed in $table"
      status changed.c 2 "$file, $table changed"
    done
    case $name in
      bare_student) ;;  # a linear network gives no number of what is none
      squashed | bounded) grep -q "tanh of the network's mean" "$file" || say "$file: it does not say what it gives" ;;  # what is no number goes through a tanh
      *)
        sed 's/fault += obs.*/;/; s/fault += action.*/;/' "$file" > changed.c
        status changed.c 3 "$file without its fault"
        ;;
    esac
    sed 's/const float a = \(.*\);/const float a = 0.9f * \1;/' "$file" > changed.c
    status changed.c 1 "$file with other actions"
    if [ -n "$shield" ]; then
      grep -q '^ \* Guards: ' "$file" || say "$file: its guards are not said"
      for side in low high; do
        sed "s/a [<>] [a-z0-9_]*_$side\[i\] ? [a-z0-9_]*_$side\[i\]/0 ? 0/" "$file" > changed.c
        status changed.c 1 "$file without the guards' $side ends"
      done
    fi
    case $eyes in *EYES*) ;; *) continue ;; esac
    sed 's/fault += points.*/;/; s/fault += best.*/;/' "$file" > changed.c
    status changed.c 3 "$file with points that are not finite"
    sed 's/if (count < 1).*/;/' "$file" > changed.c
    status changed.c 3 "$file without a point"
    sed 's/best\[i\] = back\[i\]/best[i] += back[i]/; s/best\[i\] = front\[i\]/best[i] += front[i]/' "$file" > changed.c
    status changed.c 1 "$file with a sum in the place of the largest"
    sed 's/return (float)k;/return 0.0f;/' "$file" > changed.c
    status changed.c 1 "$file with points that all are the origin"
    nm -u object | grep -vE 'memcpy|__stack_chk_fail|_GLOBAL_OFFSET_TABLE_' > calls && say "$file calls $(cat calls)"
  done
  compared "$name" 1e-6 -Os
  error=$(stated largest_error "${name}_8.out")
  # half of a probe's rows are played where there are eyes, and with a memory they change the rows after them: other rows
  # than the error is stated of
  case $eyes in *EYES*STATE*) most=1.25 ;; *) most=1 ;; esac
  compared "${name}_8" "$(awk -v e="$error" -v most=$most 'BEGIN { print most * e + 1e-5 }')" -Os
  awk -v e="$error" '{ exit !($1 > 0 && e < 0.1) }' found || say "${name}_8: $(cat found), stated $error"
  grep -q 'differ from' "${name}_8.c" || say "${name}_8: its error is not in it"
  checked=$((checked + 1))
}
eyes= shield=
check tanh --set hidden=64,64 --set activation=tanh
check elu --set hidden=128,64,32 --set activation=elu
check relu --set hidden=30 --set activation=relu
check bare --set hidden=16,17 --set normalize_obs=false
check state --set hidden=16,16 --set std_mode=state
check part --set hidden=16,16 --set 'actor_obs=proprioception,object.*'
check ball --task ball_run --set hidden=16,16
# of learners from a replay memory: tanh of the mean
check squashed --task ball_run --algo sac_lag --set hidden=16,16 --set start_steps=64 --set batch_rows=32
check bounded --task ball_run --algo td3_lag --set hidden=16,16 --set start_steps=64 --set batch_rows=32
# a cost of the commands alone, and a mean outside of two windows
shield='--shield project'
check held --set cost_mode=command --set window.ff2.low=35 --set window.ff3.high=25 --set hidden=16,16
shield=
cloud='--set encoder_points=40 --set cloud_width=24 --set cloud_height=24'
eyes=-DEYES
# shellcheck disable=SC2086
check sees --set encoder=16,24 --set actor_obs=vision --set hidden=16,16 $cloud
# shellcheck disable=SC2086
check flat --set encoder=12 --set encoder_activation=tanh --set hidden=16 --set activation=relu --set normalize_obs=false $cloud
eyes='-DEYES -DKINDS'
# of this seed the encoder of 512 steps feels where points are, as int8 too
# shellcheck disable=SC2086
check kinds --seed 3 --set encoder=8,8,9 --set encoder_classes=4 --set encoder_activation=elu --set encoder_origin=0.1,-0.2,0.9 \
  --set encoder_range=0.4 --set hidden=17 --set std_mode=state $cloud
eyes='-DEYES -DKINDS -DCOLORS'
# shellcheck disable=SC2086
check tints --set encoder=8,9 --set encoder_classes=5 --set encoder_color=true --set goal_points=8 --set hidden=16 $cloud
# with a memory the rows are an episode of 1,000 decisions
eyes=-DSTATE
check gru --set memory=gru:13 --set hidden=16
check bare_gru --set memory=gru:6 --set hidden= --set std_mode=state
check team_gru --algo mappo --set memory=gru:5 --set hidden=16
check bare_team_gru --algo mappo --set memory=gru:4 --set hidden= --set std_mode=state
check past --set history=4 --set hidden=16
check some --set history=3 --set 'history_fields=object.*' --set 'actor_obs=proprioception,object.*' --set hidden=16
drawn='--set scale.kp=0.8..1.2 --set show_dynamics=true --set latent=3'
# shellcheck disable=SC2086
check student $drawn --set latent_from=history --set history=4 --set 'history_fields=*.joint_position,object.*' --set hidden=16 --set latent_hidden=9,8
# shellcheck disable=SC2086
check bare_student $drawn --set latent_from=history --set history=2 --set hidden= --set latent_hidden= --set normalize_obs=false
eyes=
# shellcheck disable=SC2086
check latent $drawn --set hidden=16,17 --set latent_hidden=9
# eyes beside a history, and beside a latent of a teacher and of a student
eyes='-DEYES -DSTATE'
# shellcheck disable=SC2086
check eyes_past --set encoder=16,24 --set actor_obs=vision --set history=3 --set 'history_fields=*.joint_position' --set hidden=16,16 $cloud
eyes='-DEYES -DKINDS -DCOLORS -DSTATE'
# shellcheck disable=SC2086
check eyes_student $drawn --seed 3 --set encoder=8,12 --set encoder_classes=4 --set encoder_color=on --set latent_from=history --set history=3 \
  --set 'history_fields=*.joint_position' --set hidden=16 --set latent_hidden=9,8 $cloud
eyes='-DEYES -DKINDS'
# shellcheck disable=SC2086
check eyes_latent $drawn --seed 3 --set encoder=8,12 --set encoder_classes=4 --set hidden=16,17 --set latent_hidden=9 $cloud
for name in gru past student eyes_past eyes_student; do
  sed 's/state\[i\] = next\[i\]/state[i] = state[i]/' $name.c > changed.c
  status changed.c 1 "$name without its memory"
done
eyes=
[ $checked -eq 26 ] || say "$checked policies"

# several policies in one program, by one file or by several
printf '#include "%s"\n#include "%s"\n#include "%s"\n#include "%s"\nint main(void) { return 0; }\n' tanh.c elu_8.c elu_8.c kinds.c > both.c
# shellcheck disable=SC2086
cc -std=c99 $strict both.c bare.c state_8.c -o both || say "policies do not live beside each other"
cc -std=c99 -Ofast -c tanh.c -o object 2> err && say "-Ofast is taken"
grep -q 'ffast-math' err || say "-Ofast: $(cat err)"

# the manual's program, by its own line
"$tool" export --policy tanh --c policy.c --name throw > out || say "$(cat out)"
awk '/^```c$/ { block = ""; on = 1; next } /^```/ { if (on && block ~ /"policy.c"/) printf "%s", block; on = 0 } on { block = block $0 "\n" }' \
  "$here/../../examples/manual/memory.md" > host.c
line=$(grep -o '`cc -std=c99 host.c [^`]*`' "$here/../../examples/manual/memory.md" | tr -d '`')
$line -Wall -Wextra -pedantic -Werror && ./host > out && [ "$(wc -l < out)" -eq 40 ] || say "the program of memory.md: '$line'"

# names
"$tool" export --policy tanh --c own.c --json > out && grep -q '"name":"hand_over_safe_finger"' out || say "$(cat out)"
grep -q 'right.joint_position' own.c || say "the observation's fields are not said"
grep -q 'object.position  m  (not observed)$' sees.c || say "an entry that is not observed is not marked"
grep -q 'goal.position  m$' sees.c || say "what is seen is not said"
for bad in 1a a-b 'a b' '' _a a__b 'a;b' "$(printf '%064d' 0 | tr 0 a)" 'é'; do
  "$tool" export --policy tanh --c bad.c --name "$bad" > out 2> err
  [ $? -eq 2 ] && [ "$(wc -l < err)" -eq 1 ] || say "--name $bad: $(cat err)"
done
"$tool" export --policy tanh --onnx x --int8 > out 2> err
[ $? -eq 2 ] || say "--int8 without --c"
# guards: of a task that declares some, in the C file alone
for bad in 'tanh --c bad.c --shield project' 'trained:reorient --c bad.c --shield project' 'held --c bad.c --shield predict' 'held --c bad.c --shield project:zero=false' 'held --c bad.c --shield projekt' 'held --shield project --probe x' \
  'held --c bad.c --shield project --onnx x' 'held --c bad.c --shield project --safetensors x'; do
  # shellcheck disable=SC2086
  "$tool" export --policy $bad > out 2> err
  [ $? -eq 2 ] && [ "$(wc -l < err)" -eq 1 ] || say "export --policy $bad: $(cat err)"
done
grep -q 'action\[[0-9]*\]  -0.5 .. 0.5$' held.c || say "held.c: $(grep 'action\[' held.c | head -5)"
[ "$(grep -c '^ \*   action\[' held.c)" -eq 3 ] || say "held.c: the bounds of other entries are said"
[ ! -e bad.c ] || say "a file with a bad name was written"
exit $failed
