"""Two computers whose network is cut and restored, with a node on each, and what arrived when."""

import contextlib
import json
import os
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from tests.cut_network import ADDRESSES, CutNetwork, cut_network
from tests.link_peer import LATCHED

ROOT = Path(__file__).resolve().parents[1]
TOPICS = ("tf", "status", "map", "key_vel", "goal")


# A subscriber as roscpp is one: it says nothing of itself once it is connected, and has no limits.
SUBSCRIBER = """
import select, sys
from ur.run.master.tcpros import NoTopic, listen_to
from ur.run.master.xml_rpc import call_method
robot, topic = sys.argv[1:]
_, _, uri = call_method((robot, 11311), "lookupNode", ["/x", "/robot"], 5.0)
listener = listen_to(uri, topic, keep=0, timeout=5.0, caller="/x")
told = False
try:
    while True:
        select.select([listener], [], [])
        if listener.receive() and not told:
            told = True
            print("receives", flush=True)
except NoTopic:
    print("ended", flush=True)
"""


@dataclass(frozen=True, slots=True)
class Arrival:
    """A message: which topic, when it was sent and when it came (s), and the threads of the process that it came to."""

    topic: str
    sent: float
    came: float
    threads: int


@dataclass(slots=True)
class LinkTrial:
    """The running trial. `arrivals` grows while it runs; `other_lines` are what rospy prints."""

    network: CutNetwork
    environment: Mapping[str, Mapping[str, str]]
    processes: dict[str, subprocess.Popen[str]] = field(default_factory=dict)
    arrivals: list[Arrival] = field(default_factory=list)
    other_lines: list[str] = field(default_factory=list)

    @property
    def laptop(self) -> subprocess.Popen[str]:
        return self.processes["laptop"]

    def start_subscriber(self, topic: str) -> subprocess.Popen[str]:
        """Start another subscriber on the laptop, which prints `receives`, and `ended` when its connection does."""
        command = [sys.executable, "-c", SUBSCRIBER, ADDRESSES["robot"], f"/{topic}"]
        return self.network.start("laptop", command, self.environment["laptop"])

    def collect(self, lines: Iterator[str]) -> None:
        for line in lines:
            if not line.startswith('["'):
                self.other_lines.append(line)  # of rospy
                continue
            topic, sent, came, threads = json.loads(line)
            self.arrivals.append(Arrival(topic, sent, came, threads))

    def wait_for_all(self, since: float, limit: float) -> dict[str, float]:
        """When each topic came first: s after `since`. Those that did not come within the limit are missing."""
        while True:
            first: dict[str, float] = {}
            for each in list(self.arrivals):
                if each.came >= since:
                    first.setdefault(each.topic, each.came - since)
            if set(first) >= set(TOPICS) or time.monotonic() > since + limit:
                return first
            time.sleep(0.05)

    def count(self, topic: str, since: float) -> int:
        return sum(each.topic == topic and each.came >= since for each in list(self.arrivals))

    def threads(self, topic: str) -> int:
        """The threads of the process that receives a topic, at its newest message."""
        return next(each.threads for each in reversed(list(self.arrivals)) if each.topic == topic)

    def keeps_to(self, topic: str, most: int) -> bool:
        """Whether the process that receives a topic has no more threads than so many."""
        return self.threads(topic) <= most

    def oldest(self, since: float) -> float:
        """The greatest age (s) of a message of a stream that came after `since`."""
        ages = [
            each.came - each.sent for each in list(self.arrivals) if each.came >= since and each.topic not in LATCHED
        ]
        return max(ages, default=0.0)


@contextlib.contextmanager
def link_trial(*, plain: bool = False) -> Iterator[LinkTrial]:
    """A master and a node on the robot, a node on the laptop; `plain` leaves rospy as it is."""
    with cut_network() as network, tempfile.TemporaryDirectory() as folder:
        kept = {name: value for name, value in os.environ.items() if not name.startswith("ROS")}
        uri = f"http://{ADDRESSES['robot']}:11311"
        path = os.pathsep.join((str(ROOT), str(ROOT / "src")))
        common = kept | {"ROS_MASTER_URI": uri, "ROS_HOME": folder, "ROS_LOG_DIR": folder, "PYTHONPATH": path}
        on = {side: common | {"ROS_IP": address} for side, address in ADDRESSES.items()}
        network.start("robot", ["/usr/bin/rosmaster", "--core", "-p", "11311"], on["robot"])
        trial = LinkTrial(network, on)
        readers = []
        for side in ADDRESSES:
            command = [sys.executable, "-m", "tests.link_peer", side, *(["--plain"] if plain else [])]
            process = network.start(side, command, on[side])
            trial.processes[side] = process
            assert process.stdout
            reader = threading.Thread(target=trial.collect, args=(iter(process.stdout.readline, ""),))
            reader.start()
            readers.append((process, reader))
        try:
            yield trial
        finally:
            for process, reader in readers:
                process.kill()
                reader.join()
