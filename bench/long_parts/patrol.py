"""A simulated robot that patrols under `ur launch`, and what its processes use."""

from __future__ import annotations

import itertools
import os
import re
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

from bench.long_parts.process_samples import Sample, describe_growth, take_sample
from bench.navigation_parts.worlds import GOALS

_ROOT = Path(__file__).resolve().parents[2]
_WORLD = "maze"
_EACH = 5.0  # minutes between two samples
_WARM = 60.0  # minutes after which nothing may grow; in shorter runs the first third
_LAUNCH = """<launch>
  <machine name="localhost" address="localhost"/>
  <include file="$(find ubiquity_launches)/m_robot_base/launch/m_robot_base.launch.xml">
    <arg name="robot_base" value="stage"/> <arg name="world" value="{world}"/> <arg name="speed" value="{speed}"/>
  </include>
  <include file="$(find ubiquity_launches)/m_move_base/launch/m_move_base.launch.xml">
    <arg name="robot_base" value="stage"/> <arg name="map_file" value="{maps}/{world}.yaml"/>
  </include>
  <include file="$(find ubiquity_launches)/n_keyboard_navigate/launch/n_keyboard_navigate.launch.xml"/>
</launch>
"""


def measure(sizes: Sequence[int], speed: float) -> Iterator[str]:
    """Yield lines about all processes together at these minutes; `speed` is 1 for real time, 0 for as fast as can be.

    Raises SystemExit when something grows.
    """
    last = max(sizes)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # so that the nodes are ended then, too
    with tempfile.TemporaryDirectory(prefix="bench_long_") as name, Patrol(Path(name), speed) as patrol:
        patrol.wait_for_result()
        began, wall, samples = patrol.now(), time.monotonic(), list[Sample]()
        times = sorted({*sizes, *itertools.takewhile(lambda each: each < last, itertools.count(_EACH, _EACH))})
        for minutes in times:
            patrol.sleep_until(began + 60.0 * minutes)
            samples.append(take_sample(patrol.process.pid, patrol.logs, minutes))
            if minutes in sizes:
                yield _describe(samples[-1])
        elapsed = time.monotonic() - wall
        factor = 60.0 * last / elapsed
        print(f"  {last} minutes in {elapsed / 60.0:.1f} ({factor:.1f} times real time), {patrol.count()}")
        lines, growing = describe_growth(samples, min(_WARM, last / 3.0))
        print("\n".join(lines))
    if growing:
        raise SystemExit(f"grows: {', '.join(growing)}")


def _describe(sample: Sample) -> str:
    every = sample.processes.values()
    memory, files = sum(each.memory for each in every), sum(each.files for each in every)
    threads = sum(each.threads for each in every)
    return f"{sample.minutes:5g} min: {memory:.0f} MB, {files} files, {threads} threads, {sample.logs:.1f} MB of logs"


class Patrol:
    """`ur launch` with a simulated robot, navigation and `keyboard_navigate`, which gets one goal after the other.

    A context manager: everything has ended at its end.
    """

    def __init__(self, folder: Path, speed: float) -> None:
        with socket.socket() as probe:
            probe.bind(("localhost", 0))
            port = probe.getsockname()[1]
        self.logs = folder / "log"
        launch = folder / "patrol.launch"
        launch.write_text(
            _LAUNCH.format(world=_WORLD, speed=speed, maps=_ROOT / "ubiquity_launches" / "n_map_server" / "maps")
        )
        changes = {
            "ROS_MASTER_URI": f"http://localhost:{port}",
            "ROS_HOSTNAME": "localhost",
            "ROS_LOG_DIR": str(self.logs),
            "ROS_HOME": str(folder / "home"),
            "XDG_STATE_HOME": str(folder / "state"),
            "XDG_DATA_HOME": str(folder / "data"),
        }
        os.environ.update(changes)
        self._results: dict[str, int] = {}
        self._first = threading.Event()
        self._errors = (folder / "errors").open("w+")
        self._simulated = speed != 1.0
        self.process = subprocess.Popen(
            [sys.executable, "-I", "-m", "ur", "launch", str(launch)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._errors,
            text=True,
            start_new_session=True,
        )
        self._reader = threading.Thread(target=self._drive, daemon=True)
        self._reader.start()

    def __enter__(self) -> Patrol:
        return self

    def __exit__(self, *_: object) -> None:
        self.process.send_signal(signal.SIGINT)
        try:
            self.process.wait(60)
        finally:
            self.process.kill()
            self._errors.close()

    def wait_for_result(self, limit: float = 300.0) -> None:
        """Wait until the robot has reached the first goal, and the clock of the run is known."""
        if not self._first.wait(limit) or self.process.poll() is not None:
            self._fail()
        if self._simulated:
            import rospy

            rospy.init_node("bench_long", disable_signals=True, anonymous=True)

    def now(self) -> float:
        """The time of the run in seconds: simulated, or real."""
        if not self._simulated:
            return time.monotonic()
        import rospy

        while not rospy.get_time():
            time.sleep(0.1)
        return float(rospy.get_time())

    def sleep_until(self, due: float) -> None:
        """Wait for a time of the run. Raises SystemExit when the run has ended."""
        while self.now() < due:
            if self.process.poll() is not None:
                self._fail()
            time.sleep(0.2)

    def count(self) -> str:
        """The number of goals by their results."""
        return "goals: " + ", ".join(f"{number} {result}" for result, number in sorted(self._results.items()))

    def _drive(self) -> None:
        goals, results = self.process.stdin, self.process.stdout
        assert goals is not None
        assert results is not None
        try:
            for x, y, heading in itertools.cycle(GOALS[_WORLD]):
                goals.write(f"g {x} {y} {heading}\n")
                goals.flush()
                while not (line := results.readline()).startswith("g "):
                    if not line:
                        return
                result = re.split(r",| after [\d.]+ s", line.partition(": ")[2])[0].strip()
                self._results[result] = self._results.get(result, 0) + 1
                self._first.set()
        except OSError:
            return  # the run has ended

    def _fail(self) -> None:
        self._errors.seek(0)
        raise SystemExit("error: the run has ended, or reached no goal:\n" + self._errors.read()[-3000:])
