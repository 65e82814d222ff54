"""What comes on the topics of a domain of ROS 2, by a node that hears them; see `matrix_topics`."""

import json
import os
import select
import struct
import subprocess
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

from tests.e2e.matrix_table import Topic
from tests.e2e.matrix_topics import Heard
from tests.ros2_session import PYTHON, ROOT

NODE = ROOT / "ubiquity_launches/lib/node"
EARS = Path(__file__).with_name("matrix_ears_node.py")
_END = 20.0  # s


def ros2_environment(folder: Path, domain: str) -> dict[str, str]:
    """What is set where ROS 2 is selected: a domain and facts of its own, on this computer only."""
    return {
        "AMENT_PREFIX_PATH": str(PYTHON.parents[1]),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        "ROS_DISTRO": "kilted",
        "ROS_DOMAIN_ID": domain,
        "ROS_VERSION": "2",
        "UR_FACTS": str(folder / f"run/ubiquity_launches/facts-{domain}.json"),
    }


class Ros2Ears:
    """See `Ears`. `close` ends the node."""

    def __init__(self, environment: Mapping[str, str], topics: Sequence[Topic]) -> None:
        self.heard: dict[str, Heard] = {topic.name: Heard() for topic in topics}
        self.frames: dict[str, set[str]] = {}
        nowhere = subprocess.DEVNULL
        command = [str(NODE), str(EARS), *self.heard]
        self._node = subprocess.Popen(
            command, env=dict(environment), stdin=nowhere, stdout=subprocess.PIPE, stderr=nowhere
        )
        self._rest = b""

    def connect(self) -> None:
        """See Ears: the node looks for who publishes by itself."""

    def listen(self, seconds: float) -> None:
        """See Ears."""
        assert self._node.stdout
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            if not select.select([self._node.stdout], [], [], left)[0]:
                return
            data = os.read(self._node.stdout.fileno(), 1 << 16)
            assert data, "the node that hears topics has ended"
            *lines, self._rest = (self._rest + data).split(b"\n")
            for line in lines:
                self._take(json.loads(line))

    def close(self) -> None:
        """See Ears."""
        assert self._node.stdout
        self._node.terminate()
        try:
            self._node.wait(_END)
        except subprocess.TimeoutExpired:
            self._node.kill()
            self._node.wait()
        self._node.stdout.close()

    def _take(self, line: dict[str, object]) -> None:
        messages, frames = line["messages"], line["frames"]
        assert isinstance(messages, list)
        assert isinstance(frames, dict)
        self.frames = {child: set(parents) for child, parents in frames.items()}
        for topic, came, start in messages:
            self.heard[topic].times.append(came)
            self.heard[topic].stamps.append(read_cdr_stamp(bytes.fromhex(start)))


def read_cdr_stamp(message: bytes) -> float:
    """The stamp of a message in CDR that begins with a std_msgs/Header, in s; 0 for one that is too short."""
    if len(message) < 12:
        return 0.0
    seconds, nanoseconds = struct.unpack_from("<iI", message, 4)
    return float(seconds + nanoseconds * 1e-9)
