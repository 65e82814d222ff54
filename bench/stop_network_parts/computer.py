"""A computer of the bench with a starter on it, as seen from here."""

import contextlib
import json
import os
import select
import signal
import subprocess
import time
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from bench.stop_network_parts.lane import Lane
from bench.stop_network_parts.recorder import LeaseNote, Output, Truth, read_leases, read_outputs, read_truth
from bench.stop_parts.nursery import Sent, read_sent
from tests.hosts.bench import REPOSITORY, Machine, wait_until

_FOLDER = "/var/lib/ur-bench"
_PARTS = "stop_network_parts"
# One of these is in each command line that the bench starts inside.
_OURS = (_PARTS, "rosmaster", "-m ur", "ur_nodes", "robot_state_publisher")
_PATIENCE = 60.0  # s: for a starter to import what it starts


def put_first(processes: Iterable[int], priority: int = 1) -> None:
    """Schedule processes before all others of this kernel with a lower priority, where it allows that."""
    with contextlib.suppress(OSError):
        for process in processes:
            for thread in Path(f"/proc/{process}/task").iterdir():  # what a thread starts later inherits it
                os.sched_setscheduler(int(thread.name), os.SCHED_RR, os.sched_param(priority))


class Computer:
    """A machine and what was started on it. `master` is the address of the robot, `nice` the priority of all of it.

    A robot and a laptop have processors of their own. Here they share one, so what is measured goes before the rest.
    `ros_home` is the folder inside that ROS writes to.
    """

    ros_home = f"{_FOLDER}/ros"

    def __init__(self, machine: Machine, master: str, nice: int) -> None:
        self.machine = machine
        self._environment = {
            "ROS_MASTER_URI": f"http://{master}:11311",
            "ROS_IP": machine.address,
            "ROS_HOME": self.ros_home,
            "ROS_PACKAGE_PATH": f"{REPOSITORY}/ubiquity_launches:/usr/share",
            "PYTHONDONTWRITEBYTECODE": "1",
        }
        self._nice = nice
        self._process: subprocess.Popen[str] | None = None
        self._starts = 0
        machine.run(f"mkdir -p {self.ros_home}").check()

    def start(self) -> None:
        """Start the starter, again after all was killed."""
        self.stop()
        self._starts += 1
        module = f"bench.{_PARTS}.starter {_FOLDER}/{self._starts}"
        line = f"cd {REPOSITORY} && exec nice -n {self._nice} .venv/bin/python -m {module} 2>>{_FOLDER}/starter.log"
        self._process = subprocess.Popen(
            self.machine.command_line(line, environment=self._environment),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )
        self._answer("start")

    def order(self, do: str, **arguments: Any) -> Any:
        """Have the starter carry out an order; what it answers. Raises RuntimeError when it does not."""
        assert self._process
        assert self._process.stdin
        try:
            self._process.stdin.write(json.dumps({"do": do, **arguments}) + "\n")
            self._process.stdin.flush()
        except OSError:
            raise RuntimeError(f"{self.machine.name}: {do}: the starter has ended\n{self.log()}") from None
        return self._answer(do)

    def _answer(self, do: str) -> Any:
        assert self._process
        assert self._process.stdout
        ready = select.select([self._process.stdout], [], [], _PATIENCE)[0]
        line = self._process.stdout.readline() if ready else ""
        if not line:
            raise RuntimeError(f"{self.machine.name}: {do}: no answer from the starter\n{self.log()}")
        return json.loads(line)

    def log(self) -> str:
        """The last lines of all that was written inside."""
        folder = self._folder()
        paths = [
            folder / "starter.log",
            *(folder / f"{self._starts}" / name for name in ("nodes.log", "navigation.log")),
        ]
        texts = [path.read_text(errors="replace") for path in paths if path.exists()]
        return "\n".join("\n".join(text.splitlines()[-12:]) for text in texts)

    def stop(self) -> None:
        """End the starter and all it started."""
        if self._process is None:
            return
        with contextlib.suppress(LookupError):  # the machine is down
            self.kill_everything()
        self._process.kill()
        self._process.wait()
        for stream in (self._process.stdin, self._process.stdout):
            if stream:
                with contextlib.suppress(OSError):
                    stream.close()
        self._process = None

    def processes(self) -> list[int]:
        """Process numbers, as seen from here, of all that was started inside."""
        return [number for number, line in self.machine.processes() if any(word in line for word in _OURS)]

    def kill_everything(self) -> None:
        """SIGKILL to all that was started inside."""
        for number in self.processes():
            with contextlib.suppress(ProcessLookupError):
                os.kill(number, signal.SIGKILL)

    def suspend(self) -> None:
        """SIGSTOP to every process of the computer but its init."""
        self._signal_all(signal.SIGSTOP)

    def resume(self) -> None:
        """SIGCONT to every process of the computer."""
        self._signal_all(signal.SIGCONT)
        if self._process:  # nsenter stops with what it started
            self._process.send_signal(signal.SIGCONT)

    def _signal_all(self, number: signal.Signals) -> None:
        leader = self.machine.leader
        for process, _ in self.machine.processes():
            if process != leader:
                with contextlib.suppress(ProcessLookupError):
                    os.kill(process, number)

    def queued(self, address: str) -> int:
        """The number of bytes that its kernel still has to send to an address over TCP, dead programs' included."""
        done = subprocess.run(
            ["nsenter", "--target", str(self.machine.leader), "--net", "--", "ss", "-Htan", "dst", address],
            capture_output=True,
            text=True,
            check=True,
        )
        return sum(int(line.split()[2]) for line in done.stdout.splitlines())

    def wait_sent(self, address: str, deadline: float) -> None:
        """Wait until nothing is left to be sent to an address."""
        wait_until(lambda: self.queued(address) == 0, f"{self.machine.name}: sends what it has", deadline)

    def read_sent(self, lane: Lane, since: float) -> list[Sent]:
        """All velocities that commanders of a lane published here since a monotonic time, in order of time."""
        return self._read_stamps(f"*/stamps-*-{lane.name}", since)

    def read_beats(self, lane: Lane, since: float) -> list[Sent]:
        """When commanders of a lane took part in its lease, since a monotonic time, in order of time."""
        return self._read_stamps(f"*/stamps-*-{lane.name}.beats", since)

    def _read_stamps(self, pattern: str, since: float) -> list[Sent]:
        found = [sent for path in self._folder().glob(pattern) for sent in read_sent(path)]
        return sorted((sent for sent in found if sent.monotonic >= since), key=lambda sent: sent.monotonic)

    def read_outputs(self, lane: Lane, since: float) -> list[Output]:
        """All velocities that arrived at the motors of a lane since a monotonic time, in order of time."""
        found = [out for path in self._folder().glob(f"*/{lane.name}.outputs") for out in read_outputs(path)]
        return sorted(out for out in found if out.at >= since)

    def outer(self, pids: dict[str, int]) -> dict[str, int]:
        """The process numbers as seen from here of some that are known inside."""
        inner = {}
        for number in self.processes():
            with contextlib.suppress(OSError):
                lines = Path(f"/proc/{number}/status").read_text().splitlines()
                (own,) = (line.split()[-1] for line in lines if line.startswith("NSpid:"))
                inner[int(own)] = number
        return {name: inner[pid] for name, pid in pids.items()}

    def read_truth(self, lane: Lane, since: float) -> list[Truth]:
        """The true motion of a simulated robot since a monotonic time, in order of time."""
        found = [truth for path in self._folder().glob(f"*/{lane.name}.truth") for truth in read_truth(path)]
        return sorted(truth for truth in found if truth.at >= since)

    def read_leases(self, lane: Lane, since: float) -> list[LeaseNote]:
        """The leases of a lane's mux since a monotonic time, in order of time."""
        found = [note for path in self._folder().glob(f"*/{lane.name}.leases") for note in read_leases(path)]
        return sorted((note for note in found if note.at >= since), key=lambda note: note.at)

    def _folder(self) -> Path:
        return self.machine.root / _FOLDER.lstrip("/")


class Waits:
    """The time that processes have waited for a processor, noted now and then by `look`. Process ids are the host's."""

    def __init__(self) -> None:
        self._pids: dict[str, int] = {}
        self._seen: dict[str, list[tuple[float, float]]] = {}

    def follow(self, pids: dict[str, int]) -> None:
        """Follow these from now on, by name."""
        self._pids = dict(pids)
        self._seen = {name: [] for name in pids}

    def look(self) -> None:
        """Note all of them now."""
        for name, pid in self._pids.items():
            total = 0
            with contextlib.suppress(OSError, IndexError):  # it may end just now
                for task in Path(f"/proc/{pid}/task").iterdir():
                    total += int((task / "schedstat").read_text().split()[1])
                self._seen[name].append((time.monotonic(), total / 1e9))

    def between(self, name: str, since: float, until: float) -> float:
        """Seconds that a process waited between two times of the monotonic clock, as far as was looked at."""
        seen = self._seen.get(name, [])
        before = [total for at, total in seen if at <= since] or [total for _, total in seen[:1]]
        after = [total for at, total in seen if at >= until] or [total for _, total in seen[-1:]]
        return max(0.0, after[0] - before[-1]) if before and after else 0.0
