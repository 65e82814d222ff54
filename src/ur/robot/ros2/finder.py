"""Program that finds ROS 2 on a computer: one file that uses only the standard library.

It reads a request as JSON from standard input: `variables` to read, `files` that shells read, `graph`, the text of the
program that reads the graph, and `environment`, variables for that program. It prints the answer as JSON. `ur` sends it
to robots on which this project is not installed.
"""

# A program for small computers, which run it before this project is installed.
# ruff: noqa: PTH110, PTH111, PTH112, PTH113, PTH115, PTH116, PTH119, PTH120, PTH123, PTH207, PTH208

import glob
import json
import os
import pwd
import re
import shlex
import subprocess
import sys
from typing import Any

MOST_PROCESSES = 200
FIRST_PERSON = 1000  # the first user id that is not a system user's
_IFF_UP, _IFF_LOOPBACK, _IFF_MULTICAST = 0x1, 0x8, 0x1000
_LISTENING = {"tcp": "0A", "udp": "07"}
_KEPT = ("AMENT_PREFIX_PATH", "PYTHONPATH", "LD_LIBRARY_PATH", "_ROS_WHEELS_BOOTSTRAP_COMPLETE")
_LOST = re.compile(r"/dev/shm/fastrtps_\w+_el \(deleted\)")  # noqa: S108 - the lock of its owner
_RELEASE = re.compile(r"/opt/ros/([a-z]{1,20})/")
# Nothing is imported from the current folder: of PYTHONPATH, which ROS 2 needs, only absolute paths are kept.
_READ_PROGRAM = (
    "import os, sys; sys.path[:0] = [each for each in os.environ.get('PYTHONPATH', '').split(':')"
    " if os.path.isabs(each)]; exec(sys.stdin.read())"
)
GRAPH_SECONDS = 45
SHELL_SECONDS = 10


def read(path: str) -> str:
    """Return the text of a file, '' if it cannot be read."""
    try:
        with open(path, errors="replace") as file:
            return file.read()
    except OSError:
        return ""


def find_processes(variables: list[str]) -> list[dict[str, Any]]:
    """Find processes that have loaded a client library of ROS 2, or whose command line refers to ROS 2."""
    found: list[dict[str, Any]] = []
    for entry in sorted(os.listdir("/proc"), key=lambda name: int(name) if name.isdigit() else 0):
        if not entry.isdigit() or int(entry) == os.getpid() or len(found) >= MOST_PROCESSES:
            continue
        argv = read(f"/proc/{entry}/cmdline").replace("\0", " ").strip()
        maps = read(f"/proc/{entry}/maps")
        if not argv or not ("/librcl.so" in maps if maps else ("--ros-args" in argv or "/opt/ros/" in argv)):
            continue
        environment = read_environment(entry)
        unit = find_unit(entry)
        shown = environment if environment is not None else read_unit_environment(unit)
        release = _RELEASE.search(maps or argv) or _RELEASE.search((shown or {}).get("AMENT_PREFIX_PATH", "") + "/")
        found.append(
            {
                "pid": int(entry),
                "user": owner(entry),
                "argv": argv[:300],
                "distro": release[1] if release else read_release((shown or {}).get("ROS_DISTRO", "")),
                "unit": unit,
                "variables": {name: (shown or {})[name][:400] for name in variables if (shown or {}).get(name)},
                "readable": shown is not None,
                "lost": lost_memory(entry),
                "environment": shown or {},
            }
        )
    return found


def read_release(text: str) -> str:
    """Return the name of a release; '' if the text is not one."""
    return text if re.fullmatch("[a-z]{1,20}", text) else ""


def owner(entry: str) -> str:
    """Return the user name of a process's owner."""
    try:
        return pwd.getpwuid(os.stat(f"/proc/{entry}").st_uid).pw_name
    except (OSError, KeyError):
        return ""


def read_environment(entry: str) -> dict[str, str] | None:
    """Return the environment variables of a process; None without permission."""
    try:
        with open(f"/proc/{entry}/environ", errors="replace") as file:
            pairs = (each.partition("=") for each in file.read().split("\0"))
    except OSError:
        return None
    return {name: value for name, _, value in pairs if name}


def find_unit(entry: str) -> str:
    """Return the systemd system unit of a process, '' if it belongs to none."""
    found = re.search(
        r"/system\.slice/(?:[^\n]{0,500}/)?([A-Za-z0-9@._:\\-]{1,192}\.service)", read(f"/proc/{entry}/cgroup")
    )
    return found[1] if found else ""


def read_unit_environment(unit: str) -> dict[str, str] | None:
    """Return the environment variables that a unit sets."""
    if not unit:
        return None
    shown = run(["systemctl", "show", "-p", "Environment", "--value", unit], 5)
    pairs = (each.partition("=") for each in shlex.split(shown))
    return {name: value for name, _, value in pairs if name} or None


def run(command: list[str], seconds: float, **more: Any) -> str:
    """Return the output of a command, '' if it fails."""
    try:
        done = subprocess.run(
            command,
            stdin=more.pop("stdin", subprocess.DEVNULL),
            capture_output=True,
            timeout=seconds,
            check=False,
            **more,
        )
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return str(done.stdout, errors="replace")


def read_shell(variables: list[str]) -> dict[str, str]:
    """Return the environment variables in a new terminal."""
    shell = os.environ.get("SHELL") or pwd.getpwuid(os.getuid()).pw_shell or "/bin/sh"
    clean = {name: os.environ[name] for name in ("HOME", "USER", "LOGNAME", "LANG", "PATH") if name in os.environ}
    shown = run([shell, "-ic", "env"], SHELL_SECONDS, env=clean, start_new_session=True)
    pairs = (line.partition("=") for line in shown.splitlines())
    return {name: value[:400] for name, _, value in pairs if name in variables and value}


def find_settings(files: list[str], variables: list[str]) -> list[list[str]]:
    """Find lines of shell files that set one of the variables."""
    pattern = re.compile(rf"^\s*(?:export\s+)?({'|'.join(variables)})=", re.M)
    return [[file, name] for file in files for name in sorted(set(pattern.findall(read(os.path.expanduser(file)))))]


def find_files(environments: list[dict[str, str]]) -> dict[str, bool]:
    """Return the settings files of middlewares that variables refer to, and whether they exist."""
    found: dict[str, bool] = {}
    for variables in environments:
        for name in ("FASTRTPS_DEFAULT_PROFILES_FILE", "FASTDDS_DEFAULT_PROFILES_FILE", "CYCLONEDDS_URI"):
            value = variables.get(name, "")
            if value and not value.lstrip().startswith("<"):
                path = value.removeprefix("file://")
                found[path] = os.path.isfile(path)
    return found


def find_ports() -> list[int]:
    """Find the ports on which processes listen."""
    found = set()
    for kind, state in _LISTENING.items():
        for line in (read(f"/proc/net/{kind}") + read(f"/proc/net/{kind}6")).splitlines():
            row = line.split()
            if len(row) > 3 and row[3] == state and ":" in row[1]:
                found.add(int(row[1].rpartition(":")[2], 16))
    return sorted(found)


def find_no_multicast() -> list[str]:
    """Find network interfaces that are up, not loopback, and without multicast."""
    found = []
    for folder in sorted(glob.glob("/sys/class/net/*")):
        text = read(f"{folder}/flags").strip()
        flags = int(text, 16) if re.fullmatch(r"0x[0-9a-f]{1,8}", text) else _IFF_LOOPBACK
        if flags & _IFF_UP and not flags & (_IFF_LOOPBACK | _IFF_MULTICAST):
            found.append(os.path.basename(folder))
    return found


def find_forgotten(processes: list[dict[str, Any]], root: str = "", first: int = FIRST_PERSON) -> list[str]:
    """Find users whose units lose their shared memory when the user's last login ends (logind.conf(5))."""
    files = [f"{root}/etc/systemd/logind.conf"]
    for folder in ("usr/lib", "run", "etc"):
        files += glob.glob(f"{root}/{folder}/systemd/logind.conf.d/*.conf")
    files[1:] = sorted(files[1:], key=os.path.basename)
    settings = [value for file in files for value in re.findall(r"^\s*RemoveIPC\s*=\s*(\w+)", read(file), re.M)]
    if settings and settings[-1].lower() in ("no", "false", "off", "0"):
        return []
    found = {each["user"] for each in processes if each["unit"] and number_of(each["user"]) >= first}
    return sorted(each for each in found if not os.path.exists(f"{root}/var/lib/systemd/linger/{each}"))


def lost_memory(entry: str) -> bool:
    """Return whether a process's shared memory of Fast DDS was removed, so that new nodes cannot reach it."""
    return any(_LOST.fullmatch(read_link(file)) for file in glob.glob(f"/proc/{entry}/fd/*"))


def read_link(path: str) -> str:
    """Return the target of a symbolic link, '' if it is not one."""
    try:
        return os.readlink(path)
    except OSError:
        return ""


def number_of(user: str) -> int:
    """Return the id of a user, -1 for an unknown name."""
    try:
        return pwd.getpwnam(user).pw_uid
    except KeyError:
        return -1


def read_graph(request: dict[str, Any], installations: Any, processes: Any, shell: dict[str, str]) -> Any:
    """Run the program that reads the graph with the Python of a release, in the domain of the found processes."""
    program, variables = request["graph"], request["variables"]
    readable = [each for each in processes if each["readable"]]
    settings = [json.dumps(each["variables"], sort_keys=True) for each in readable]
    chosen = max(settings, key=settings.count) if settings else ""
    leader = readable[settings.index(chosen)] if settings else None
    base = {name: os.environ[name] for name in ("HOME", "PATH", "LANG", "USER") if name in os.environ}
    # The shell of the unit's user sets these, too, if no process exists to read them from.
    base.update(leader["variables"] if leader else {name: shell[name] for name in variables if name in shell})
    base.update(request["environment"])
    folders = [each["folder"] for each in installations]
    wanted = f"/opt/ros/{leader['distro']}" if leader else ""
    folder = wanted if wanted in folders else folders[-1] if folders else ""
    if folder:
        line = f'. {shlex.quote(folder + "/setup.bash")} >/dev/null 2>&1; exec python3 -I -c "$1"'
        command = ["bash", "-c", line, "bash", _READ_PROGRAM]
    elif leader and os.path.basename(leader["argv"].split(" ")[0]).startswith("python"):
        base.update({name: leader["environment"][name] for name in _KEPT if name in leader["environment"]})
        command = [leader["argv"].split(" ")[0], "-I", "-c", _READ_PROGRAM]
    else:
        return None, "no Python with rclpy was found"
    try:
        done = subprocess.run(
            command, input=program.encode(), env=base, capture_output=True, timeout=GRAPH_SECONDS, check=False
        )
    except subprocess.TimeoutExpired:
        return None, f"its nodes did not answer within {GRAPH_SECONDS} s"
    except OSError as problem:
        return None, str(problem)
    lines = done.stdout.decode(errors="replace").splitlines()
    try:
        return json.loads(lines[-1]), ""
    except (IndexError, ValueError):
        reported = done.stderr.decode(errors="replace").strip().splitlines()
        return None, reported[-1][:300] if reported else f"the program ended with exit code {done.returncode}"


def find(request: dict[str, Any]) -> dict[str, Any]:
    """Find all facts about ROS 2; see `ur.robot.ros2.seen_graph.Ros2`."""
    variables: list[str] = request["variables"]
    # Find the releases below /opt/ros. Releases of ROS 1 have no ament index.
    found = []
    for setup in sorted(glob.glob("/opt/ros/*/setup.bash")):
        folder = os.path.dirname(setup)
        index = f"{folder}/share/ament_index/resource_index"
        if os.path.isdir(index):
            kinds = glob.glob(f"{index}/rmw_typesupport/rmw_*")
            middlewares = sorted({os.path.basename(each) for each in kinds} - {"rmw_implementation"})
            found.append({"distro": os.path.basename(folder), "folder": folder, "middlewares": middlewares})
    installations = found
    processes = find_processes(variables)
    if not installations and not processes:
        return {}
    shell = read_shell(variables)
    called = {name: os.environ[name][:400] for name in variables if os.environ.get(name)}
    graph, problem = None, ""
    if request["graph"]:
        graph, problem = read_graph(request, installations, processes, shell)
    for each in processes:
        del each["environment"]
    return {
        "installations": installations,
        "processes": processes,
        "shell": shell,
        "called": called,
        "settings": find_settings(request["files"], variables),
        "files": find_files([*(each["variables"] for each in processes), shell]),
        "ports": find_ports(),
        "no_multicast": find_no_multicast(),
        "forgotten": find_forgotten(processes),
        "graph": graph,
        "problem": problem,
    }


if __name__ == "__main__":
    json.dump(find(json.load(sys.stdin)), sys.stdout)
