#!/bin/bash
# Run `ur`. In a clone it sets this computer up on first use; it says nothing and costs next to nothing when there is
# nothing to do. The same script is installed by the wheel, where it chooses between two environments.
root="$(readlink -f "${BASH_SOURCE[0]}")"
root="${root%/*}"
where="" help=""
[[ " ${*:2} " == *" --help "* || " ${*:2} " == *" -h "* ]] && help=yes
[[ ${1-} == debian ]] && echo "warning: 'ur debian' is now 'ur setup debian'; the old spelling ends with the next release" >&2 && set -- setup "$@"
data="${XDG_DATA_HOME:-$HOME/.local/share}/ubiquity_launches"
debian="$data/debian-13/enter.bash" # where this release has no ROS 1
if [[ -d $root/src/ur ]]; then
  # It is not there before it is made, nor after; `ur` itself shows the help.
  [[ "${1-} ${2-}" == "setup debian" && -z $help ]] && exec bash "$root/tools/debian_root.bash" "${@:3}"
  stamp="$root/.venv/ready-run"
  [[ -e $stamp ]] && read -r where <"$stamp"
  # The environment knows where its Debian root is, whatever HOME is now.
  [[ -r $root/.venv/debian ]] && read -r data <"$root/.venv/debian" && debian="$data/enter.bash"
  if [[ $where != "$root" || $root/requirements/run.lock -nt $stamp || $root/tools/set_up.bash -nt $stamp ||
    $root/src/ur/system/ros_packages.txt -nt $stamp || $root/pyproject.toml -nt $stamp ||
    ( -e $root/.ros2 && $root/requirements/ros2.lock -nt $stamp ) || ( -e $root/.venv/debian && ! -e $debian ) ]]; then
    if [[ $EUID -eq 0 && -n ${SUDO_USER-} && ! -O $root ]]; then
      echo "error: $root belongs to another user, and sudo would leave files of root in it" >&2
      echo "  help: run it without sudo, which it asks for where it needs root: $root/ur" >&2
      exit 2
    fi
    if [[ $* == mcp ]]; then # an assistant's program would not wait
      printf 'error: what assistants need is not installed; install it first: %q mcp --install\n' "$root/ur" >&2
      exit 2
    fi
    bash "$root/tools/set_up.bash" run || exit
  fi
  # Python would answer Ctrl-C with a traceback until our first line runs, which lets a signal that waits take effect.
  [[ -e $root/.venv/block-signal ]] && exec /usr/bin/env --block-signal=INT "$root/.venv/bin/python" -I -m ur "$@"
  exec "$root/.venv/bin/python" -I -m ur "$@" # -I: nothing of the current folder is imported
fi

# Of a wheel: in the environment that pipx or uv has made, or in the one of the user, which was made from that (ur.installed).
environment="${root%/lib/python*/site-packages/ur/_project*}" # this may be the launch library's bin/ur
environment="${environment%/bin}"
made="$data/.venv"
[[ -r $made/ready-run ]] && read -r where <"$made/ready-run"
[[ -n $where && $environment -ef $made ]] && environment="$where"
packages=("$environment"/lib/python*/site-packages)
if [[ "${1-} ${2-}" == "setup debian" && -z $help && -e ${packages[0]}/ur/_project/tools/debian_root.bash ]]; then
  exec bash "${packages[0]}/ur/_project/tools/debian_root.bash" "${@:3}"
fi
records=("${packages[0]}"/ubiquity_launches-*.dist-info/RECORD)
if [[ ! -x $environment/bin/python || ( -n $where && $where -ef $environment && ! ${records[0]} -nt $made/ready-run &&
  ( ! -e $made/debian || -e $debian ) ) ]]; then
  environment="$made"
fi
if [[ ! -x $environment/bin/python ]]; then
  echo "error: ur is not installed in a virtual environment, expected one around $root" >&2
  echo "  help: install it with pipx or uv: pipx install ubiquity-launches" >&2
  exit 2
fi
[[ -e $environment/block-signal ]] && exec /usr/bin/env --block-signal=INT "$environment/bin/python" -I -m ur "$@"
exec "$environment/bin/python" -I -m ur "$@"
