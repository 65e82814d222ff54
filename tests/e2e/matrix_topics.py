"""What comes on the topics of a master, without a ROS library: when, by the stamps in messages, and the frames."""

import itertools
import select
import struct
import time
from collections import Counter
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from statistics import median

from tests.e2e.matrix_table import Topic

from ur.run.master.client import Master
from ur.run.master.tcpros import NoTopic, TopicConnection, listen_to
from ur.run.master.xml_rpc import CallRefused, Unanswered

TF = ("/tf", "/tf_static")
_TOLERANCE = 0.2
_SPAN = 0.9  # s
_MOST = 300


@dataclass(slots=True)
class Heard:
    """What came on a topic: the stamps of its messages, in s, and when they came."""

    stamps: list[float] = field(default_factory=list)
    times: list[float] = field(default_factory=list)


class Ears:
    """Listens to topics of a master. `listen` waits for messages; `frames` maps each frame to its parents."""

    def __init__(self, master: Master, topics: Sequence[Topic]) -> None:
        self._master = master
        self._topics = topics
        self._links: dict[tuple[str, str], TopicConnection] = {}
        self.heard: dict[str, Heard] = {topic.name: Heard() for topic in topics}
        self.frames: dict[str, set[str]] = {}

    def connect(self) -> None:
        """Ask who publishes, and hang on to whoever is new."""
        try:
            publishers = dict(self._master.call("getSystemState")[0])
        except (Unanswered, CallRefused):
            return
        for name in (*self.heard, *TF):
            for node in publishers.get(name, ()):
                if (name, node) not in self._links:
                    with suppress(NoTopic, Unanswered, CallRefused):  # asked again at the next look
                        uri = self._master.call("lookupNode", node)
                        keep = 1 << 20 if name in TF else 12
                        self._links[name, node] = listen_to(uri, name, keep=keep, timeout=5.0, caller="/matrix")

    def listen(self, seconds: float) -> None:
        """Take what comes."""
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            keys = {link.fileno(): key for key, link in self._links.items()}
            for descriptor in select.select(list(keys), [], [], left)[0]:
                self._take(keys[descriptor])

    def _take(self, key: tuple[str, str]) -> None:
        try:
            messages = self._links[key].receive()
        except NoTopic:
            self._links.pop(key).close()
            return
        for message in messages:
            if key[0] in TF:
                for parent, child in read_transforms(message):
                    self.frames.setdefault(child, set()).add(parent)
            else:
                heard = self.heard[key[0]]
                heard.times.append(time.monotonic())
                heard.stamps.append(read_stamp(message))

    def close(self) -> None:
        """Hang up."""
        for link in self._links.values():
            link.close()


def read_stamp(message: bytes) -> float:
    """The stamp of a message that begins with a std_msgs/Header, in s; 0 for one that is too short."""
    if len(message) < 12:
        return 0.0
    seconds, nanoseconds = struct.unpack_from("<II", message, 4)
    return float(seconds + nanoseconds * 1e-9)


def read_transforms(message: bytes) -> list[tuple[str, str]]:
    """Parent and child of each transform of a tf2_msgs/TFMessage."""
    found = []
    (count,) = struct.unpack_from("<I", message)
    offset = 4
    for _ in range(count):
        offset += 12  # seq, stamp
        names = []
        for _ in range(2):
            (size,) = struct.unpack_from("<I", message, offset)
            names.append(message[offset + 4 : offset + 4 + size].decode().lstrip("/"))
            offset += 4 + size
        offset += 56  # translation and rotation: seven float64
        found.append((names[0], names[1]))
    return found


def measure_rate(topic: Topic, heard: Heard) -> float | None:
    """Messages a second of late, None while too little came to tell: less than a second of it.

    Those with the same stamp belong together (sonars that take turns). The median of the steps between stamps does not
    mind single messages that were dropped.
    """
    moments = heard.stamps if topic.stamped else heard.times
    counts = Counter(moments[-_MOST:])
    stamps = sorted(counts)
    if len(stamps) < 2 or stamps[-1] - stamps[0] < _SPAN:
        return None
    step = median(after - before for before, after in itertools.pairwise(stamps))
    together = median([counts[stamp] for stamp in stamps[1:-1]] or [1])  # at the ends some may be missing
    return together / step


def find_fault(topic: Topic, heard: Heard) -> str:
    """What is wrong with what came on a topic, for people; '' when it is as expected."""
    if topic.rate is None:
        return "" if heard.times else f"{topic.name}: nothing came"
    rate = measure_rate(topic, heard)
    if rate is None:
        return f"{topic.name}: {len(heard.times)} messages came, expected {topic.rate:g} a second"
    slow, fast = topic.rate * (1 - _TOLERANCE), topic.rate * (1 + _TOLERANCE)
    if rate < slow or (rate > fast and not topic.at_least):
        return f"{topic.name}: {rate:.1f} messages a second, expected {topic.rate:g}"
    return ""


def find_tree_faults(frames: Mapping[str, set[str]], root: str, wanted: Sequence[str]) -> list[str]:
    """Why frames (each with its parents) are not one tree with this root that holds those that are wanted."""
    faults = [
        f"frame {child} has the parents {', '.join(sorted(parents))}, expected one"
        for child, parents in sorted(frames.items())
        if len(parents) > 1
    ]
    everything = set(frames).union(*frames.values())
    roots = everything - set(frames)
    if roots != {root}:
        faults.append(f"roots of the frames: {', '.join(sorted(roots)) or 'none'}, expected {root}")
    missing = sorted(set(wanted) - everything)
    if missing:
        faults.append(f"frames that are not there: {', '.join(missing)}, only {', '.join(sorted(everything))}")
    return faults
