"""`ur launch` on ROS 2 beside a bare spawn of the same nodes; a node of the bench finds those in the graph.

That node announces itself every 20 ms: a new node may lose the answer to its first announcement, and is in the graph
only after the next one, which would add up to 3 s at random. It leaves before the nodes do: Fast DDS 3.2 can deadlock
when it announces a node at the moment at which another one leaves.
"""

from __future__ import annotations

import contextlib
import os
import signal
import statistics
import subprocess
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

import psutil
import rclpy
from bench.either_ros import ROOT, node_name, select_ros
from rclpy.node import Node

_NODE = ROOT / "ubiquity_launches/n_sleep_forever/bin/sleep_forever"
_LIMIT = 120.0  # s
_LOOK = 0.004  # s
_PROFILE = """\
<dds><profiles><participant profile_name="bench" is_default_profile="true"><rtps><builtin><discovery_config>
<leaseAnnouncement><sec>0</sec><nanosec>20000000</nanosec></leaseAnnouncement>
</discovery_config></builtin></rtps></participant></profiles></dds>
"""
MOST = 1.3
"""The time until nodes are registered, over that of a bare spawn."""


def measure_ros2(counts: Sequence[int], repeats: int, folder: Path) -> bool:
    """Print medians for each number of nodes; return whether `ur launch` keeps its limit and leaves nothing."""
    environment = select_ros("2", folder)
    environment.pop("PYTHONDONTWRITEBYTECODE", None)  # users of ur do not set it
    profile = folder / "fast_dds.xml"
    profile.write_text(_PROFILE, encoding="utf-8")
    os.environ["FASTDDS_DEFAULT_PROFILES_FILE"] = str(profile)  # of this process alone
    good = True
    for count in counts:
        commands = {
            "ur launch": [str(ROOT / "ur"), "launch", _write(folder, count)],
            "bare spawn": ["/bin/bash", "-c", _spawn(count)],
        }
        found: dict[str, list[tuple[float, float]]] = {name: [] for name in commands}
        _measure(commands["ur launch"], environment, count)  # bytecode and caches are warm
        for _ in range(repeats):
            for name, command in commands.items():
                found[name].append(_measure(command, environment, count))
        medians = {
            name: [statistics.median(column) for column in zip(*rows, strict=True)] for name, rows in found.items()
        }
        ratio = medians["ur launch"][0] / medians["bare spawn"][0]
        print(f"{count} nodes on ROS 2")
        for name, (registered, stop) in medians.items():
            print(f"  {name:14}  registered {registered:6.3f} s  stop {stop:6.3f} s")
        print(f"  ratio of registered {ratio:.2f}", flush=True)
        good = good and ratio <= MOST
    left = _kill(commands["ur launch"], environment, count)
    print(f"{left} of {count} nodes run 10 s after kill -9 of the supervisor", flush=True)
    return good and not left


@contextlib.contextmanager
def _graph() -> Iterator[Node]:
    rclpy.init()
    node = Node("bench_run")
    try:
        yield node
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


def _write(folder: Path, count: int) -> str:
    nodes = (f'<node pkg="ubiquity_launches" type="sleep_forever" name="r{number}"/>' for number in range(count))
    path = folder / f"bench_{count}.launch"
    path.write_text(f"<launch>{''.join(nodes)}</launch>", encoding="utf-8")
    return str(path)


def _spawn(count: int) -> str:
    started = " ".join(f"{_NODE} --ros-args -r __node:=r{number} &" for number in range(count))
    return f"trap 'kill -INT $(jobs -p)' INT TERM; {started} wait; wait"


def _registered(graph: Node) -> int:
    return sum(name[:1] == "r" and name[1:].isdigit() for name in set(graph.get_node_names()))


def _wait(graph: Node, count: int) -> None:
    end = time.monotonic() + _LIMIT
    while _registered(graph) != count:
        if time.monotonic() > end:
            raise SystemExit(f"error: {_registered(graph)} nodes in the graph after {_LIMIT:g} s, expected {count}")
        time.sleep(_LOOK)


def _nodes(count: int) -> list[psutil.Process]:
    names = {f"r{number}" for number in range(count)}
    found = []
    for process in psutil.process_iter():
        with contextlib.suppress(psutil.Error):
            words = process.cmdline()
            if "ur_nodes.sleep_forever_node" in words and node_name(words) in names:
                found.append(process)
    return found


def _runs(process: psutil.Process) -> bool:
    with contextlib.suppress(psutil.NoSuchProcess):
        return bool(process.status() != psutil.STATUS_ZOMBIE)
    return False


@contextlib.contextmanager
def _started(
    command: Sequence[str], environment: dict[str, str], count: int
) -> Iterator[tuple[subprocess.Popen[bytes], list[psutil.Process], float]]:
    """Start a command; gives it, its nodes, and the seconds until the last one was registered. Ends what is left."""
    nowhere = subprocess.DEVNULL
    with _graph() as graph:
        begin = time.monotonic()
        process = subprocess.Popen(
            command, env=environment, stdin=nowhere, stdout=nowhere, stderr=nowhere, start_new_session=True
        )
        try:
            _wait(graph, count)
            registered = time.monotonic() - begin
        except BaseException:
            _end(process, _nodes(count))
            raise
    nodes = _nodes(count)
    try:
        yield process, nodes, registered
    finally:
        _end(process, nodes)


def _end(process: subprocess.Popen[bytes], nodes: list[psutil.Process]) -> None:
    process.kill()
    process.wait()
    for each in nodes:
        with contextlib.suppress(psutil.NoSuchProcess):
            each.kill()


def _measure(command: Sequence[str], environment: dict[str, str], count: int) -> tuple[float, float]:
    """Return the seconds until the last node is registered, and from Ctrl-C until none runs."""
    with _started(command, environment, count) as (process, nodes, registered):
        begin = time.monotonic()
        process.send_signal(signal.SIGINT)
        process.wait(_LIMIT)
        while any(map(_runs, nodes)):
            time.sleep(_LOOK)
        return registered, time.monotonic() - begin


def _kill(command: Sequence[str], environment: dict[str, str], count: int) -> int:
    """Return how many nodes run 10 s after the supervisor was killed."""
    with _started(command, environment, count) as (process, nodes, _registered_after):
        process.kill()
        process.wait()
        end = time.monotonic() + 10.0
        while any(map(_runs, nodes)) and time.monotonic() < end:
            time.sleep(_LOOK)
        return sum(map(_runs, nodes))
