#!/bin/bash
# Set this computer up on first use, then run `ur`. Says nothing and costs next to nothing when there is nothing to do.
root="$(readlink -f "${BASH_SOURCE[0]}")"
root="${root%/*}"
[[ ${1-} == debian && " ${*:2} " != *" --help "* && " ${*:2} " != *" -h "* ]] && exec bash "$root/tools/debian_root.bash" "${@:2}" # it is not there before it is made, nor after
stamp="$root/.venv/ready-run"
where=""
debian="${XDG_DATA_HOME:-$HOME/.local/share}/ubiquity_launches/debian-13/enter.bash" # where this release has no ROS 1
[[ -e $stamp ]] && read -r where <"$stamp"
if [[ $where != "$root" || $root/requirements/run.lock -nt $stamp || $root/tools/set_up.bash -nt $stamp ||
  $root/src/ur/system/ros_packages.txt -nt $stamp || $root/pyproject.toml -nt $stamp ||
  ( -e $root/.venv/debian && ! -e $debian ) ]]; then
  if [[ $EUID -eq 0 && -n ${SUDO_USER-} && ! -O $root ]]; then
    echo "error: $root belongs to another user, and sudo would leave files of root in it" >&2
    echo "  help: run it without sudo, which it asks for where it needs root: $root/ur" >&2
    exit 2
  fi
  bash "$root/tools/set_up.bash" run || exit
fi
exec "$root/.venv/bin/python" -I -m ur "$@" # -I: nothing of the current folder is imported
