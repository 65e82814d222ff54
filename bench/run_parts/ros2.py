"""`ur launch` on ROS 2 beside a bare spawn of the same nodes; a node of the bench finds those in the graph.

It announces itself every 20 ms: a new node may lose the answer to its first announcement, and is in the graph only
after the next one, which would add up to 3 s at random.
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

from ur_nodes.ros2.attached import PROFILE

_NODE = ROOT / "ubiquity_launches/n_sleep_forever/bin/sleep_forever"
_LIMIT = 120.0  # s
_END = 120.0  # s
_LOOK = 0.004  # s
MOST = 1.3
"""The time until nodes are registered, over that of a bare spawn."""


def measure_ros2(counts: Sequence[int], repeats: int, folder: Path) -> bool:
    """Print medians for each number of nodes; return whether `ur launch` keeps its limit and leaves nothing."""
    environment = select_ros("2", folder)
    environment.pop("PYTHONDONTWRITEBYTECODE", None)  # users of ur do not set it
    good = True
    with _graph(folder) as graph:
        for count in counts:
            commands = {
                "ur launch": [str(ROOT / "ur"), "launch", _write(folder, count)],
                "bare spawn": ["/bin/bash", "-c", _spawn(count)],
            }
            found: dict[str, list[tuple[float, float]]] = {name: [] for name in commands}
            _measure(graph, commands["ur launch"], environment, count)  # bytecode and caches are warm
            for _ in range(repeats):
                for name, command in commands.items():
                    found[name].append(_measure(graph, command, environment, count))
            medians = {
                name: [statistics.median(column) for column in zip(*rows, strict=True)] for name, rows in found.items()
            }
            ratio = medians["ur launch"][0] / medians["bare spawn"][0]
            print(f"{count} nodes on ROS 2")
            for name, (registered, stop) in medians.items():
                print(f"  {name:14}  registered {registered:6.3f} s  stop {stop:6.3f} s")
            print(f"  ratio of registered {ratio:.2f}", flush=True)
            good = good and ratio <= MOST
        left = _kill(graph, commands["ur launch"], environment, count)
        print(f"{left} of {count} nodes run 10 s after kill -9 of the supervisor", flush=True)
    return good and not left


@contextlib.contextmanager
def _graph(folder: Path) -> Iterator[Node]:
    profile = folder / "fast_dds.xml"
    own = PROFILE.read_text(encoding="utf-8")
    profile.write_text(own.replace("<sec>1</sec>", "<sec>0</sec><nanosec>20000000</nanosec>"), encoding="utf-8")
    os.environ["FASTDDS_DEFAULT_PROFILES_FILE"] = str(profile)  # of this process alone
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


def _wait(graph: Node, count: int, limit: float) -> None:
    end = time.monotonic() + limit
    while _registered(graph) != count:
        if time.monotonic() > end:
            raise SystemExit(f"error: {_registered(graph)} nodes in the graph after {limit:g} s, expected {count}")
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


def _start(command: Sequence[str], environment: dict[str, str]) -> subprocess.Popen[bytes]:
    nowhere = subprocess.DEVNULL
    return subprocess.Popen(
        command, env=environment, stdin=nowhere, stdout=nowhere, stderr=nowhere, start_new_session=True
    )


def _measure(graph: Node, command: Sequence[str], environment: dict[str, str], count: int) -> tuple[float, float]:
    """Return the seconds until the last node is registered, and from Ctrl-C until none runs."""
    _wait(graph, 0, _END)
    begin = time.monotonic()
    process = _start(command, environment)
    _wait(graph, count, _LIMIT)
    registered = time.monotonic() - begin
    nodes = _nodes(count)
    begin = time.monotonic()
    process.send_signal(signal.SIGINT)
    process.wait(_END)
    while any(map(_runs, nodes)):
        time.sleep(_LOOK)
    return registered, time.monotonic() - begin


def _kill(graph: Node, command: Sequence[str], environment: dict[str, str], count: int) -> int:
    """Return how many nodes run 10 s after the supervisor was killed."""
    _wait(graph, 0, _END)
    process = _start(command, environment)
    _wait(graph, count, _LIMIT)
    nodes = _nodes(count)
    process.kill()
    process.wait()
    end = time.monotonic() + 10.0
    while any(map(_runs, nodes)) and time.monotonic() < end:
        time.sleep(_LOOK)
    left = [each for each in nodes if _runs(each)]
    for each in left:
        each.kill()
    return len(left)
