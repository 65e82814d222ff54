"""Transfer of maps between this computer and robots over ssh. A received map is checked before it is stored."""

import base64
import binascii

from ur.maps.exchange import MOST_PACKED, pack_map, unpack_map
from ur.maps.names import check_map_name, is_map_name
from ur.maps.store import MapStore
from ur.request.remote.connection import connect_robot, robot_address
from ur.robot.ssh.shell import quote
from ur.source.diagnostic import UserError, user_error
from ur.source.suggest import did_you_mean

_FOLDER = '"${XDG_DATA_HOME:-$HOME/.local/share}/ubiquity_launches/maps"'
_MISSING, _IN_USE, _EXISTS, _TOO_LARGE = 7, 8, 9, 10
_SECONDS = 300.0
_LIST = f'cd {_FOLDER} 2>/dev/null || exit 0; for f in */map.yaml; do [ -f "$f" ] && echo "${{f%/map.yaml}}"; done; :'


def list_remote(robot: str) -> list[str]:
    """Return the sorted names of the maps on a robot. Raises UserError if there is no connection."""
    with connect_robot(robot_address(robot)) as shell:
        return sorted({name for name in shell.run(_LIST).out.splitlines() if is_map_name(name)})


def fetch_map(store: MapStore, name: str, robot: str, new_name: str) -> str:
    """Copy a map from a robot; return the robot's address. Raises UserError, without a change on this computer."""
    check_map_name(name)
    address = robot_address(robot)
    with store.arriving(new_name) as folder, connect_robot(address) as shell:
        script = (
            f"cd {_FOLDER}/{quote(name)} 2>/dev/null && [ -f map.yaml ] || exit {_MISSING}; "
            "sent=$(mktemp) && trap 'rm -f \"$sent\"' EXIT || exit 1; trap 'exit 1' HUP INT TERM; "
            f'flock -n -E {_IN_USE} .lock tar -czf "$sent" --exclude=.lock . || exit; '
            f'[ "$(stat -c %s "$sent")" -le {MOST_PACKED} ] || exit {_TOO_LARGE}; base64 "$sent"'
        )
        done = shell.run(script, timeout=_SECONDS)
        if done.code:
            raise _explain(done.code, name, str(address), done.err, list(shell.run(_LIST).out.splitlines()))
        try:
            data = base64.b64decode(done.out.replace("\n", ""), validate=True)
        except (binascii.Error, ValueError):
            raise _problem(f"{address}: map {name!r} did not arrive whole", "copy it again") from None
        unpack_map(data, folder, f"map {name!r} of {address}")
    return str(address)


def send_map(store: MapStore, name: str, robot: str, new_name: str) -> str:
    """Copy a map to a robot; return the robot's address. Raises UserError, without a change on the robot."""
    store.resolve(name)
    target = quote(check_map_name(new_name))
    address = robot_address(robot)
    with store.claim(name):
        text = base64.b64encode(pack_map(store.path(name))).decode()
    script = (
        f"mkdir -p {_FOLDER} && cd {_FOLDER} || exit 1; [ ! -e {target}/map.yaml ] || exit {_EXISTS}; "
        'find . -maxdepth 1 -name ".new-*" -mmin +15 -exec rm -rf {} +; '  # of a robot that was switched off
        'new=".new-$$"; trap \'rm -rf "$new"\' EXIT; trap "exit 1" HUP INT TERM; mkdir "$new" && '
        # If the network fails, the robot is not informed that no more data follow.
        f'timeout {_SECONDS:g} base64 -d | tar -xzf - -C "$new" && sync "$new"/* || exit 1; '
        # A mapping that has just started has a folder and a lock, but no picture yet.
        f"[ ! -d {target} ] || flock -n -E {_IN_USE} {target}/.lock rm -rf {target} || exit; "
        f'[ ! -e {target} ] || exit {_EXISTS}; mv -T "$new" {target}'
    )
    with connect_robot(address) as shell:
        done = shell.run(script, stdin=text, timeout=_SECONDS)
    if done.code:
        raise _explain(done.code, new_name, str(address), done.err, [])
    return str(address)


def _explain(code: int, name: str, place: str, reported: str, names: list[str]) -> UserError:
    if code == _MISSING:
        near = did_you_mean(name, names)
        help_ = f"did you mean {near!r}?" if near else f"'ur maps --robot {place}' lists its maps"
        return _problem(f"{place} has no map {name!r}, expected one of its maps", help_)
    if code == _IN_USE:
        return _problem(
            f"map {name!r} is being changed on {place}, expected one that no program changes", "end make_map"
        )
    if code == _EXISTS:
        return _problem(f"{place} has a map {name!r} already, expected a new name", "choose another one with --as")
    if code == _TOO_LARGE:
        return _problem(
            f"map {name!r} of {place} is larger than {MOST_PACKED // 1_000_000} MB, expected a smaller one",
            "export its picture on the robot: ur maps export",
        )
    reason = (reported.strip().splitlines() or [f"exit code {code}"])[-1][:200]
    return _problem(f"{place}: map {name!r} was not copied: {reason}", "ur doctor")


def _problem(message: str, help: str) -> UserError:
    return user_error(message, rule="no-copy", help=help)
