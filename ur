#!/bin/bash
# Set this computer up on first use, then run `ur`. Says nothing and costs next to nothing when there is nothing to do.
root="$(readlink -f "${BASH_SOURCE[0]}")"
root="${root%/*}"
stamp="$root/.venv/ready-run"
where=""
[[ -e $stamp ]] && read -r where <"$stamp"
if [[ $where != "$root" || $root/requirements/run.lock -nt $stamp || $root/tools/set_up.bash -nt $stamp ||
  $root/pyproject.toml -nt $stamp ]]; then
  bash "$root/tools/set_up.bash" run || exit
fi
exec "$root/.venv/bin/python" -m ur "$@"
