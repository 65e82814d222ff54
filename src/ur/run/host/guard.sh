#!/bin/sh
# The guard of a run: guard.sh [CGROUP], with a pipe on standard input that the process host holds open.
# It is the parent of the host and a subreaper, prctl(2): whatever the host leaves behind becomes its child.
# A shell, because it does nothing but wait, and takes a twentieth of the memory of a Python that waits.

# Those that are not just waiting to be reaped, without the subshell that lists them; with $1, without processes whose
# name begins with it.
list_children() {
  read -r self _ </proc/self/stat
  for folder in /proc/[0-9]*; do
    [ "$folder" != "/proc/$self" ] || continue
    state=
    while read -r key value _; do
      case $key in
        Name:) [ -z "$1" ] || [ "$value" = "${value#"$1"}" ] || break ;;
        State:) state=$value ;;
        PPid:)
          [ "$value" != $$ ] || [ "$state" = Z ] || [ "$state" = X ] || echo "${folder#/proc/}"
          break
          ;;
      esac
    done <"$folder/status"
  done 2>/dev/null
}

# One generation after the other: the children of who dies are ours next. That may happen while a list is made, between the
# look at a child and the look at its parent, and neither is on it then: only the second empty list in a row is the end.
kill_children() {
  rounds=100
  empty=0
  while [ $rounds -gt 0 ] && [ $empty -lt 2 ]; do
    empty=$((empty + 1))
    for pid in $(list_children "$1"); do
      kill -9 "$pid" && empty=0
    done 2>/dev/null
    rounds=$((rounds - 1))
  done
}

read -r word # "ended" when the host has ended everything; nothing when it was killed
if [ "$word" != ended ]; then
  kill_children ur-motor- # drivers of motors, and their guards, end by themselves once they have stopped the motors
  tries=500 # a driver whose guard was killed, too, stops its motors within these, however busy the computer is
  empty=0
  while [ $tries -gt 0 ] && [ $empty -lt 2 ]; do
    empty=$((empty + 1))
    [ -z "$(list_children)" ] || empty=0
    sleep 0.01
    tries=$((tries - 1))
  done
  [ -z "$1" ] || echo 1 >"$1/cgroup.kill"
  kill_children
fi
tries=100
while [ -n "$1" ] && [ $tries -gt 0 ] && ! rmdir "$1" 2>/dev/null; do # the host may be on its way out
  sleep 0.01
  tries=$((tries - 1))
done
exit 0
