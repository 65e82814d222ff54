"""`ur launch` of a Python file for ROS 2 beside upstream's LaunchService, or beside a bare spawn of the same processes.

A process is a shell script that leaves a file, so that the time is that of a start; nothing of ROS has to be installed.
"""

from __future__ import annotations

import contextlib
import os
import signal
import statistics
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path

import psutil
from bench.either_ros import ROOT

_PYTHON = ROOT / ".ros2/bin/python"
_LIMIT = 60.0  # s
_LOOK = 0.002  # s
_LEFT_AFTER = 10.0  # s
MOST = 1.0
"""The time until the last process runs, over that of upstream."""
FIRST = 0.3
"""s until the first process runs, beyond that of a bare spawn."""
_SCRIPT = '#!/bin/sh\n: > "$BENCH_FOLDER/$1"\nexec sleep 7777\n'
_FILE = """
from launch import LaunchDescription
from launch.actions import ExecuteProcess
def generate_launch_description():
    return LaunchDescription([ExecuteProcess(cmd=['{script}', str(number)]) for number in range({count})])
"""
_UPSTREAM = """
import sys
from launch import LaunchDescription, LaunchService
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
service = LaunchService(noninteractive=True)
source = PythonLaunchDescriptionSource(sys.argv[1])
service.include_launch_description(LaunchDescription([IncludeLaunchDescription(source)]))
sys.exit(service.run())
"""


def measure_files(count: int, repeats: int, kills: int, folder: Path, upstream: Path | None) -> bool:
    """Print medians; return whether `ur launch` keeps its limits and leaves nothing after `kills` kills."""
    script, file = folder / "start.sh", folder / "bench.launch.py"
    script.write_text(_SCRIPT, encoding="utf-8")
    script.chmod(0o755)
    file.write_text(_FILE.format(script=script, count=count), encoding="utf-8")
    environment = {name: value for name, value in os.environ.items() if not name.startswith(("ROS_", "PYTHON", "UR_"))}
    environment |= {"HOME": str(folder), "UR_ROBOT": "sim --ros 2", "ROS_VERSION": "2", "ROS_DISTRO": "kilted"}
    environment |= {"AMENT_PREFIX_PATH": str(folder / "prefix"), "XDG_STATE_HOME": str(folder / "state")}
    spawn = f'for number in $(seq 0 {count - 1}); do "{script}" $number & done; wait'
    commands = {
        "ur launch": ([str(ROOT / "ur"), "launch", "--plain", str(file)], environment),
        "bare spawn": (["/bin/bash", "-c", spawn], environment),
    }
    if upstream is not None:
        packages = {str(path.parent) for path in upstream.rglob("package.xml")} | {str(upstream / "site")}
        their = {**environment, "PYTHONPATH": os.pathsep.join(sorted(packages))}
        commands["upstream"] = ([str(_PYTHON), "-c", _UPSTREAM, str(file)], their)
    found: dict[str, list[tuple[float, float]]] = {name: [] for name in commands}
    for command, its in commands.values():
        _measure(command, its, folder, count)  # bytecode and caches are warm
    for _ in range(repeats):
        for name, (command, its) in commands.items():
            found[name].append(_measure(command, its, folder, count))
    print(f"{count} processes of a Python launch file, medians of {repeats}")
    medians = {name: [statistics.median(each) for each in zip(*rows, strict=True)] for name, rows in found.items()}
    for name, (first, last) in medians.items():
        print(f"  {name:14}  first {first:6.3f} s  last {last:6.3f} s")
    peer = "upstream" if upstream is not None else "bare spawn"
    beyond = medians["ur launch"][0] - medians["bare spawn"][0]
    ratio = medians["ur launch"][1] / medians[peer][1]
    print(f"  last, over {peer}: {ratio:.2f}; first, beyond a bare spawn: {beyond:.3f} s", flush=True)
    command, its = commands["ur launch"]
    left = sum(_kill(command, its, folder, count) for _ in range(kills))
    print(f"  {left} processes left after {kills} times kill -9 of the supervisor", flush=True)
    return beyond <= FIRST and (upstream is None or ratio <= MOST) and not left


def _start(command: Sequence[str], environment: dict[str, str], folder: Path) -> tuple[subprocess.Popen[bytes], Path]:
    place = folder / f"started{time.monotonic_ns()}"
    place.mkdir()
    nowhere = subprocess.DEVNULL
    process = subprocess.Popen(
        command,
        env={**environment, "BENCH_FOLDER": str(place)},
        stdin=nowhere,
        stdout=nowhere,
        stderr=nowhere,
        start_new_session=True,
    )
    return process, place


def _wait(place: Path, count: int) -> None:
    end = time.monotonic() + _LIMIT
    while len(list(place.iterdir())) < count:
        if time.monotonic() > end:
            sys.exit(f"error: {len(list(place.iterdir()))} processes after {_LIMIT:g} s, expected {count}")
        time.sleep(_LOOK)


def _measure(command: Sequence[str], environment: dict[str, str], folder: Path, count: int) -> tuple[float, float]:
    """Return the seconds until the first process and the last one run."""
    begin = time.time()
    process, place = _start(command, environment, folder)
    try:
        _wait(place, count)
        times = [each.stat().st_mtime - begin for each in place.iterdir()]
    finally:
        process.send_signal(signal.SIGINT)
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(0.1)
        _end(process, place)
    return min(times), max(times)


def _running(place: Path) -> list[psutil.Process]:
    found = []
    for process in psutil.process_iter():
        with contextlib.suppress(psutil.Error):
            if process.environ().get("BENCH_FOLDER") == str(place) and process.status() != psutil.STATUS_ZOMBIE:
                found.append(process)
    return found


def _end(process: subprocess.Popen[bytes], place: Path) -> None:
    process.kill()
    process.wait()
    for each in _running(place):
        with contextlib.suppress(psutil.NoSuchProcess):
            each.kill()


def _kill(command: Sequence[str], environment: dict[str, str], folder: Path, count: int) -> int:
    """Return how many processes run 10 s after the supervisor was killed."""
    process, place = _start(command, environment, folder)
    _wait(place, count)
    process.kill()
    process.wait()
    end = time.monotonic() + _LEFT_AFTER
    while (left := _running(place)) and time.monotonic() < end:
        time.sleep(0.05)
    _end(process, place)
    return len(left)
