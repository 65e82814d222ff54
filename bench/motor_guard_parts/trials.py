"""Trials on the booted computer itself, as root: start the drivers, kill a set of processes, and wait for zeros.

Arguments: the user of the drivers; who starts guards in units of their own (`socket`: the units of `ur boot install`,
`manager`: the systemd of the user, or of the system for root, `none`); how often each set is killed; and the sets, all
without. Prints a line of JSON for each trial: the set, and the time to rest of each board, s, or null.
"""

import json
import os
import pwd
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from itertools import combinations
from pathlib import Path

from ur.robot.boot.units import command_line, guard_units, program_unit
from ur.source.project import project_folder
from ur_nodes.drivers.registry import BOARDS

VICTIMS = ("host", "driver", "guard", "ur", "cgroup", "unit")
WITH_DRIVER = {"driver", "cgroup", "unit"}
FOLDER, NOTES, LAUNCH = Path("/run/boards"), Path("/run/boards.notes"), Path("/run/drivers.launch")
UNIT, GROUPS = "ubiquity-drive", Path("/sys/fs/cgroup")
LIMIT = 3.0  # s in which a board has to rest
COMMAND = "rostopic pub -r 50 /cmd_vel geometry_msgs/Twist '{linear: {x: 0.2}}'"
PROJECT = project_folder()
# The package dbus-user-session, which the computers of the bench lack.
USER_BUS = {
    "dbus.socket": "[Socket]\nListenStream=%t/bus\n",
    "dbus.service": "[Unit]\nRequires=dbus.socket\n[Service]\nType=notify\n"
    "ExecStart=/usr/bin/dbus-daemon --session --address=systemd: --nofork --nopidfile --systemd-activation\n",
}
PYTHON = f"{PROJECT}/.venv/bin/python"


def list_sets() -> Iterator[tuple[str, ...]]:
    """All sets of victims that leave a driver or its guard alive."""
    for size in range(1, len(VICTIMS)):
        for chosen in combinations(VICTIMS, size):
            if "guard" not in chosen or not WITH_DRIVER & set(chosen):
                yield chosen


def run(*words: str) -> str:
    """Return the output of a command, whatever became of it."""
    return subprocess.run(words, capture_output=True, text=True, check=False).stdout.strip()


def find(name: str) -> list[int]:
    """The processes of a name."""
    return [int(each) for each in run("pgrep", "-x", name).split()]


def wait(condition: Callable[[], bool], what: str, limit: float = 90.0) -> None:
    """Wait for a condition. Raises TimeoutError with the end of the unit's log."""
    end = time.monotonic() + limit
    while not condition():
        if time.monotonic() > end:
            raise TimeoutError(what + "\n" + run("journalctl", "-n", "40", "--no-pager"))
        time.sleep(0.02)


def read_notes() -> dict[str, tuple[float, bool]]:
    """The last change of each board: when, and whether it moves since."""
    lines = [line.split() for line in NOTES.read_text().splitlines() if line.count(" ") == 2]
    return {name: (float(stamp), moves == "1") for stamp, name, moves in lines}


def set_up(user: str, starter: str) -> None:
    """Write the units, and start the boards, the master and the commander."""
    home = pwd.getpwnam(user).pw_dir
    node = (
        '<group ns="{0}"><remap from="cmd_vel" to="/cmd_vel"/>'
        '<include file="$(find ubiquity_launches)/n_base_driver/launch/n_base_driver.launch.xml">'
        '<arg name="robot_base" value="create2"/><arg name="board" value="{0}"/>'
        '<arg name="device" value="{1}/{0}"/></include></group>'
    )
    LAUNCH.write_text(f"<launch>{''.join(node.format(name, FOLDER) for name in BOARDS)}</launch>")
    line = command_line([PYTHON, "-I", "-m", "ur", "launch", "--plain", "--wait", str(LAUNCH)])
    unit = program_unit("drive", line, user, home, master=False)
    Path(unit.path).write_text(unit.text)
    override = Path(f"{unit.path}.d/run.conf")
    override.parent.mkdir(exist_ok=True)
    override.write_text("[Service]\nDelegate=yes\n")  # so that the run of an ordinary user has a control group, too
    for path, text in guard_units(user, home).items():
        Path(path).write_text(text)
    run("ln", "-sfn", str(PROJECT), f"{home}/ubiquity_launches")  # where units look for this project
    run("systemctl", "daemon-reload")
    run("systemctl", "restart" if starter == "socket" else "stop", "motor-guard.socket")
    if user != "root":
        for name, text in USER_BUS.items():
            Path("/etc/systemd/user", name).write_text(text)
        run("systemctl", "--global", "add-wants", "sockets.target", "dbus.socket")
        run("systemctl", "restart" if starter == "manager" else "stop", f"user@{pwd.getpwnam(user).pw_uid}.service")
    os.environ["PYTHONPATH"] = f"{PROJECT}/src:{PROJECT}"
    NOTES.write_text("")
    begin("boards", PYTHON, "-m", "bench.motor_guard_parts.boards", str(FOLDER), str(NOTES))
    begin("master", "roscore")
    wait(lambda: "/rosout" in run("rosnode", "list"), "a master")
    begin("commander", "/bin/sh", "-c", f"exec {COMMAND}")


def begin(name: str, *words: str) -> None:
    """Run a command as a unit."""
    run("systemctl", "stop", f"{name}.service")
    setting = f"--setenv=PYTHONPATH={os.environ['PYTHONPATH']}"
    run("systemd-run", f"--unit={name}", f"--working-directory={PROJECT}", setting, "--setenv=HOME=/root", *words)


def kill(chosen: Sequence[str]) -> float:
    """Kill a set at once; return when that began."""
    names = {"host": "ur-host", "driver": "ur-motor-driver", "guard": "ur-motor-guard"}
    pids = [pid for each in chosen if each in names for pid in find(names[each])]
    if "ur" in chosen:
        pids.append(int(run("systemctl", "show", "-P", "MainPID", UNIT)))
    unit = next(GROUPS.glob(f"*/{UNIT}.service"))
    groups = [*(unit.glob("ur-*") if "cgroup" in chosen else ()), *((unit,) if "unit" in chosen else ())]
    if "cgroup" in chosen and len(groups) < 1 + ("unit" in chosen):
        raise LookupError("the run has no control group")
    begun = time.monotonic()
    for pid in pids:
        with suppress(ProcessLookupError):  # it has just ended with another of the set
            os.kill(pid, signal.SIGKILL)
    for group in groups:
        (group / "cgroup.kill").write_text("1")
    return begun


def try_set(chosen: Sequence[str]) -> dict[str, float | None]:
    """Drive, kill a set, and return the times to rest."""
    run("systemctl", "start", UNIT)
    drives = lambda: len(found := read_notes()) == len(BOARDS) and all(moves for _, moves in found.values())  # noqa: E731
    wait(drives, f"all boards drive; {read_notes()}")
    wait(lambda: len(find("ur-motor-guard")) == len(BOARDS), "a guard for each board")
    # They move to a scope; and one that ends within 2 s is taken for one that systemd cannot start.
    time.sleep(2.5 if tuple(chosen) == ("guard",) else 1.0)
    before = set(find("ur-motor-guard"))
    begun = kill(chosen)
    if tuple(chosen) == ("guard",):  # the drivers go on, and have new ones
        wait(lambda: len(set(find("ur-motor-guard")) - before) == len(BOARDS), "new guards")
        time.sleep(1.0)
        begun = kill(("driver", "unit"))
    while any(moves for _, moves in read_notes().values()) and time.monotonic() < begun + LIMIT:
        time.sleep(0.02)
    found = read_notes()
    run("systemctl", "stop", UNIT)
    run("systemctl", "reset-failed", UNIT)
    wait(lambda: not find("ur-motor-guard") and not find("ur-motor-driver"), "guards end", 30.0)
    if any(moves for _, moves in read_notes().values()):
        run("systemctl", "restart", "boards")
    return {name: None if found[name][1] else round(found[name][0] - begun, 4) for name in BOARDS}


def main(user: str, starter: str, count: int, sets: Sequence[str]) -> None:
    """Print the times of each set."""
    set_up(user, starter)
    for _ in range(count):
        for chosen in [tuple(each.split("+")) for each in sets] or list_sets():
            print(json.dumps({"set": "+".join(chosen), "rest": try_set(chosen)}), flush=True)
    for name in ("commander", "master", "boards"):
        run("systemctl", "stop", name)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], int(sys.argv[3]), sys.argv[4:])
