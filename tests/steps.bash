# shellcheck shell=bash
# Steps of a check that takes long, and a table of their results and times: sourced by .ci/run and tests/nightly.
#
#   step NAME COMMAND...    run it
#   beside NAME COMMAND...  start it beside the steps that follow, which wait more than they compute
#   finish NAME             wait for what was started beside steps, and print its output
#   report                  print the table; fails where a step has failed
#
# With `only` set to NAME,... the other steps are left out. Processor time is user and system time of a step and of the
# processes that it has waited for, those in containers included.
work="$(mktemp -d)" || exit 2
trap 'kill -- $(jobs -p | sed "s/^/-/") 2>/dev/null; rm -rf "$work"' EXIT
table=() passed=0 failed=0 processor=0
declare -A known started

# is_wanted NAME: whether the step is to run; keeps its name.
is_wanted() {
  known[$1]=yes
  [[ -z ${only-} || ,$only, == *,$1,* ]]
}

# measure NAME COMMAND...: run it, and keep its end and its processor time. Run it in a subshell, whose children are all
# of this step.
measure() {
  local name="$1" code TIMEFORMAT='%3U %3S'
  shift
  { time "$@" 2>&1; } 2>"$work/$name.processor"
  code=$?
  echo $SECONDS >"$work/$name.end"
  return $code
}

# note NAME CODE BEGIN: keep the result of a step, its times and pytest's closing lines for the table.
note() {
  local result=passed seconds user=0 system=0 milliseconds
  if [[ $2 -eq 0 ]]; then ((++passed)); else result=failed && ((++failed)); fi
  seconds=$(($(<"$work/$1.end") - $3))
  read -r user system <"$work/$1.processor"
  milliseconds=$((10#${user//[!0-9]/} + 10#${system//[!0-9]/}))
  ((processor += milliseconds))
  table+=("$(printf '%-20s %4d:%02d %8d.%d  %-6s  %s' "$1" $((seconds / 60)) $((seconds % 60)) \
    $((milliseconds / 1000)) $((milliseconds % 1000 / 100)) $result \
    "$(grep -aoE '[0-9]+ (failed|passed|errors?)\b.* in [0-9.]+s' "$work/$1" | sed 's/ in [0-9.]*s//' | paste -sd ';')")")
}

step() {
  is_wanted "$1" || return 0
  local begin=$SECONDS
  printf '\n==== %s: %s\n' "$1" "${*:2}"
  measure "$@" | tee "$work/$1"
  note "$1" "${PIPESTATUS[0]}" $begin
}

beside() {
  is_wanted "$1" || return 0
  printf '\n==== %s, beside what follows: %s\n' "$1" "${*:2}"
  set -m # a process group of its own, which ends with this shell
  { exec 8>&- && measure "$@"; } >"$work/$1" 2>&1 </dev/null & # 8: a lock of the one who calls
  set +m
  started[$1]="$! $SECONDS"
}

finish() {
  [[ -n ${started[$1]-} ]] || return 0
  local pid begin code
  read -r pid begin <<<"${started[$1]}"
  wait "$pid"
  code=$?
  printf '\n==== %s\n' "$1"
  cat "$work/$1"
  note "$1" $code "$begin"
}

report() {
  local name names=${only-}
  for name in ${names//,/ }; do
    [[ -n ${known[$name]-} ]] && continue
    echo "error: no step '$name', expected of: $(printf '%s\n' "${!known[@]}" | sort | paste -sd ' ')" >&2
    ((++failed))
  done
  printf '%s\n' "" "$(printf '%-20s %7s %10s  %-6s  %s' step min:s 'processor s' result tests)" "${table[@]}"
  printf '\ntotal %d min, %d s of processor\n' $((SECONDS / 60)) $((processor / 1000))
  echo "steps: $passed passed, $failed failed"
  [[ $failed -eq 0 ]]
}
