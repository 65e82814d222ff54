"""Inspection of one or two computers for the rules, also again after the safe commands of findings."""

import fcntl
import re
import socket
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass, replace
from pathlib import Path

from ur.devices.known import Expected
from ur.robot.devices import inspect_devices
from ur.robot.discovery.ask import clock_offset
from ur.robot.doctor.findings import AdvertisedNode, ComputerPair, Finding, FixCommand, Owner, Where
from ur.robot.doctor.observe import SHELL_FILES, STRICT, observe_script, parse_side
from ur.robot.doctor.rules import OBSERVE
from ur.robot.doctor.side import Side
from ur.robot.ros2.seen_graph import inspect_ros2, receive_from
from ur.robot.ssh.openssh import SshShell
from ur.robot.ssh.shell import Shell, quote
from ur.source.diagnostic import UserError, user_error_about
from ur.source.printable import printable

FIX_SECONDS = 600.0  # packages may have to be downloaded
ATTEMPTS = 3  # names need a moment until all computers resolve them


def list_safe(findings: Sequence[Finding]) -> list[tuple[str, FixCommand]]:
    """List the commands that can do no harm, each with the rule of its finding."""
    return [(finding.rule, each) for finding in findings for each in finding.commands if each.safe]


def run_fix(command: FixCommand, local: Shell, remote: Shell, lock: Path) -> str:
    """Run a command on its computer, and describe the result.

    A command on this computer holds the file `lock`, so that other doctors wait.
    """
    shell = local if command.where == "local" else remote
    try:
        with _hold(lock) if command.where == "local" else nullcontext():
            done = shell.run(command.line, root=command.root, timeout=FIX_SECONDS)
    except UserError as problem:
        return f"failed: {problem}"
    reported = (done.err or done.out).strip().splitlines()
    return "done" if done.code == 0 else f"failed: {reported[-1] if reported else done.code}"


def inspect_until_fixed(
    before: Sequence[Finding], inspect: Callable[[], list[Finding]], pause: Callable[[], None]
) -> list[Finding]:
    """Return the findings after fixes; fixable ones are inspected again for some time, with a `pause` in between."""
    fixed = {finding.rule for finding in before if finding.fixable}
    left = inspect()
    for _ in range(ATTEMPTS - 1):
        if not any(finding.rule in fixed for finding in left):
            break
        pause()
        left = inspect()
    return left


@contextmanager
def _hold(lock: Path) -> Iterator[None]:
    lock.parent.mkdir(parents=True, exist_ok=True)
    with lock.open("w") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield


LOOK_SECONDS = 90.0
JOURNAL_LINES = 5
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,63}")
_PORT = re.compile(r"[0-9]{1,7}")  # or a process id
_TIME = re.compile(r"[0-9]{1,12}(\.[0-9]{1,9})?")
TWIN_SECONDS = 2  # zeroconf answers at once or not at all, so no name is queried for long
_LISTEN = """\
import socket, sys
server = socket.socket(); server.bind(("", 0)); server.listen(); server.settimeout(8)
print(server.getsockname()[1], flush=True)
server.accept()
"""


@dataclass(frozen=True, slots=True)
class RegisteredNode:
    """A node as the master registers it: its name, and the host and port of its address."""

    name: str
    host: str
    port: int


def inspect_computer(local: Shell) -> Side:
    """Inspect this computer without another one."""
    with ThreadPoolExecutor(2) as pool:
        ros2 = pool.submit(inspect_ros2, local, SHELL_FILES)
        side = parse_side(local.run(observe_script("", OBSERVE), timeout=LOOK_SECONDS).out, OBSERVE)
    return _with_journals(local, replace(side, ros2=ros2.result()))


def inspect_pair(
    local: Shell,
    remote: SshShell,
    nodes: Sequence[RegisteredNode],
    *,
    key_refused: bool = False,
    known: bool = False,
    selected: str = "",
    robot_login: bool = True,
    expected: tuple[Expected, ...] = (),
) -> ComputerPair:
    """Inspect both computers at once.

    `selected` is the name of the selected robot; the other arguments are those of `ComputerPair`. Raises UserError if
    the connection breaks.
    """
    mine = socket.gethostname().split(".")[0]
    other = read_name(remote)
    with ThreadPoolExecutor(10) as pool:
        newer = [pool.submit(inspect_ros2, shell, SHELL_FILES) for shell in (local, remote)]
        left = pool.submit(local.run, observe_script(f"{other}.local", OBSERVE), timeout=LOOK_SECONDS)
        right = pool.submit(remote.run, observe_script(f"{mine}.local", OBSERVE), timeout=LOOK_SECONDS)
        twins = {name: pool.submit(_resolve, local, f"{name}-2.local", TWIN_SECONDS) for name in (mine, other)}
        to_remote = pool.submit(_reaches_remote, remote)
        to_local = pool.submit(_reaches_local, remote, f"{mine}.local")
        devices = pool.submit(inspect_devices, remote)
        advertised = pool.submit(_advertised, local, remote, nodes)
        sides = parse_side(left.result().out, OBSERVE), parse_side(right.result().out, OBSERVE)
        ros2 = newer[0].result(), newer[1].result()
        if ros2[0].present and ros2[1].present:
            ends = ((local, mine, other), (remote, other, mine))
            received = [pool.submit(receive_from, *end) for end in ends]
            ros2 = replace(ros2[0], receives=received[0].result()), replace(ros2[1], receives=received[1].result())
        sides = replace(sides[0], ros2=ros2[0]), replace(sides[1], ros2=ros2[1])
    back = remote.run(f"{STRICT} {quote(f'{sides[0].user}@{mine}.local')} true")
    return ComputerPair(
        local=_with_journals(local, sides[0]),
        remote=_with_journals(remote, sides[1]),
        offset=_offset(local, remote),
        way_back="" if back.code == 0 else (back.err.strip().splitlines() or ["ssh printed nothing"])[-1],
        reaches_remote=to_remote.result(),
        reaches_local=to_local.result(),
        key_refused=key_refused,
        advertised=tuple(advertised.result()),
        known=known,
        selected=selected == other,
        twins={name: found.result() for name, found in twins.items()},
        login=f"{remote.address.user}@{other}.local",
        robot_login=robot_login,
        devices=devices.result(),
        expected=expected,
    )


def read_name(remote: Shell) -> str:
    """Return the host name of a computer, up to the first dot. Raises UserError if the answer is no host name."""
    name = remote.run("cat /proc/sys/kernel/hostname").out.strip().split(".")[0]
    if not _NAME.fullmatch(name):
        raise user_error_about(
            remote.destination,
            f"{printable(name[:40])!r} is not a host name, expected letters, digits and -",
            rule="no-facts",
            help="is it the computer that you expect? Run this again; if it persists, report it",
        )
    return name


def _with_journals(shell: Shell, side: Side) -> Side:
    """Add the last log lines of failed units, as far as the user may read them."""
    units = []
    for unit in side.failing:
        # The output of its processes; systemd's own messages only if there is none.
        for choice in (f"_SYSTEMD_UNIT={unit.name}", f"--unit={unit.name}"):
            show = f"journalctl -q -n {JOURNAL_LINES} -o cat {quote(choice)}"
            reported = shell.run(f"sudo -n {show} 2>/dev/null || {show} 2>/dev/null").out
            if reported.strip():
                break
        units.append(replace(unit, last=tuple(line.strip() for line in reported.splitlines() if line.strip())))
    return replace(side, failing=tuple(units))


def _resolve(shell: Shell, host: str, seconds: int = 8) -> frozenset[str]:
    done = shell.run(f"timeout {seconds} getent ahostsv4 {quote(host)}")
    return frozenset(line.split()[0] for line in done.out.splitlines() if line.strip())


def _advertised(local: Shell, remote: Shell, nodes: Sequence[RegisteredNode]) -> list[AdvertisedNode]:
    shells: tuple[tuple[Where, Shell], ...] = (("local", local), ("remote", remote))
    means = {host: [_resolve(shell, host) for _, shell in shells] for host in sorted({node.host for node in nodes})}
    found = []
    for node in nodes:
        lost = not all(means[node.host])
        owners = (_find_owner(where, shell, node.port) for where, shell in shells) if lost else ()
        owner = next((owner for owner in owners if owner), None)
        mine, theirs = means[node.host]
        found.append(AdvertisedNode(node.name, node.host, mine, theirs, owner))
    return found


def _find_owner(where: Where, shell: Shell, port: int) -> Owner | None:
    """Find the user's process that listens on a port."""
    script = (
        f"p=$(PATH=$PATH:/usr/sbin:/sbin ss -Hltnp 'sport = :{port}' | grep -o 'pid=[0-9]*' | head -n 1); "
        "p=${p#pid=}; "
        '[ -n "$p" ] || exit; echo "$p"; tr "\\0" " " <"/proc/$p/cmdline"; echo; '
        'sed -n "s,.*/system.slice/\\([^/]*\\.service\\)$,\\1,p" "/proc/$p/cgroup"'
    )
    lines = shell.run(script).out.splitlines()
    if len(lines) < 2 or not _PORT.fullmatch(lines[0]):
        return None
    return Owner(where, int(lines[0]), lines[1].strip(), lines[2] if len(lines) > 2 else "")


def _offset(local: Shell, remote: Shell) -> float:
    reported = [shell.run("date +%s.%N").out.strip() for shell in (local, remote, local)]
    strange = next((each for each in reported if not _TIME.fullmatch(each)), None)
    if strange is not None:
        raise user_error_about(
            remote.destination,
            f"{printable(strange[:40])!r} is not a time, expected seconds since 1970",
            rule="no-facts",
            help="is it the computer that you expect? Run this again; if it persists, report it",
        )
    before, middle, after = map(float, reported)
    return clock_offset(before, middle, after)


def _reaches_local(remote: Shell, name: str) -> bool:
    with socket.create_server(("", 0)) as server:
        port = server.getsockname()[1]
        return remote.run(f"timeout 4 bash -c {quote(f'exec 3<>/dev/tcp/{name}/{port}')}").code == 0


def _reaches_remote(remote: SshShell) -> bool:
    # In the background, for one connection or ten seconds; it cleans up after itself.
    listener = f"timeout 10 python3 -I -c {quote(_LISTEN)}"
    script = (
        f'f=$(mktemp); ({listener} >"$f" 2>/dev/null </dev/null; rm -f "$f") >/dev/null 2>&1 & '
        'i=0; while [ ! -s "$f" ] && [ $i -lt 50 ]; do sleep 0.1; i=$((i+1)); done; cat "$f"'
    )
    port = remote.run(script).out.strip()
    if not _PORT.fullmatch(port) or int(port) > 65535:
        return True  # no process listens on the remote end, as without Python: this is not a problem of ports
    try:
        socket.create_connection((remote.address.host, int(port)), timeout=4).close()
    except OSError:
        return False
    return True
