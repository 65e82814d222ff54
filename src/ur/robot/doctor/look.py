"""Collects what the rules want to know, from both ends at once."""

from __future__ import annotations

import socket
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor

from ur.robot.doctor.observe import observe_script, parse_side
from ur.robot.doctor.rules import Advertised, Pair
from ur.robot.setup.verify import STRICT, clock_offset
from ur.robot.ssh.openssh import SshShell
from ur.robot.ssh.shell import Shell, quote

_LISTEN = """\
import socket, sys
server = socket.socket(); server.bind(("", 0)); server.listen(); server.settimeout(8)
print(server.getsockname()[1], flush=True)
server.accept()
"""


def look_at_pair(
    here: Shell, there: SshShell, user: str, nodes: Sequence[tuple[str, str]], *, key_refused: bool
) -> Pair:
    """Look at both computers. `user` is the one of this computer; `nodes` are (name, host) as told to the master."""
    name = socket.gethostname().split(".")[0]
    other = there.address.host
    with ThreadPoolExecutor(2) as pool:
        left = pool.submit(here.run, observe_script(other))
        right = pool.submit(there.run, observe_script(f"{name}.local"))
        sides = parse_side(left.result().out), parse_side(right.result().out)
    back = there.run(f"{STRICT} {quote(f'{user}@{name}.local')} true")
    way_back = "" if back.code == 0 else (back.err.strip().splitlines() or ["ssh said nothing"])[-1]
    hosts = sorted({host for _, host in nodes})
    means = {host: (_resolve(here, host), _resolve(there, host)) for host in hosts}
    return Pair(
        here=sides[0],
        there=sides[1],
        offset=_offset(here, there),
        way_back=way_back,
        reaches_there=_reaches_there(there),
        reaches_here=_reaches_here(there, f"{name}.local"),
        key_refused=key_refused,
        advertised=tuple(Advertised(node, host, *means[host]) for node, host in nodes),
    )


def _resolve(shell: Shell, host: str) -> frozenset[str]:
    done = shell.run(f"timeout 8 getent ahostsv4 {quote(host)}")
    return frozenset(line.split()[0] for line in done.out.splitlines() if line.strip())


def _offset(here: Shell, there: Shell) -> float:
    readings = [float(shell.run("date +%s.%N").out) for shell in (here, there, here)]
    return clock_offset(readings[0], readings[1], readings[2])


def _reaches_here(there: Shell, name: str) -> bool:
    with socket.create_server(("", 0)) as server:
        port = server.getsockname()[1]
        return there.run(f"timeout 4 bash -c {quote(f'exec 3<>/dev/tcp/{name}/{port}')}").code == 0


def _reaches_there(there: SshShell) -> bool:
    # In the background, for one connection or ten seconds; it cleans up after itself.
    listener = f"timeout 10 python3 -c {quote(_LISTEN)}"
    script = (
        f'f=$(mktemp); ({listener} >"$f" 2>/dev/null </dev/null; rm -f "$f") >/dev/null 2>&1 & '
        'i=0; while [ ! -s "$f" ] && [ $i -lt 50 ]; do sleep 0.1; i=$((i+1)); done; cat "$f"'
    )
    port = there.run(script).out.strip()
    if not port.isdigit():
        return False
    try:
        socket.create_connection((there.address.host, int(port)), timeout=4).close()
    except OSError:
        return False
    return True
