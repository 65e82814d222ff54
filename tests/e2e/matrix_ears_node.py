"""Hears topics and transforms of ROS 2 for `matrix_ros2`: matrix_ears_node.py TOPIC ...

Ten times a second it prints a line of JSON. `messages` has, of each message since the last line, the topic as it was
asked for, the time of its arrival (monotonic, s) and its first bytes as hex; `frames` has each frame with its parents.
"""

import json
import sys
import time
from functools import partial
from typing import Any

from ur_nodes.codecs.dialect import Transforms
from ur_nodes.codecs.frames import transforms_of
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.raw import RawMessage
from ur_nodes.run import own_arguments, run

_EVERY = 0.1  # s
_START = 12  # bytes: what CDR begins with, and a stamp


class EarsNode:
    """Prints what came."""

    def __init__(self, node: Node) -> None:
        self._messages: list[tuple[str, float, str]] = []
        self._frames: dict[str, set[str]] = {}
        for topic in own_arguments(sys.argv[1:]):
            node.raw.subscribe(node.resolve(topic), partial(self._note, topic), Quality.EVERY)
        for topic in ("/tf", "/tf_static"):
            node.raw.subscribe(topic, self._take_transforms, Quality.EVERY)
        node.every(_EVERY, self._print, steady=True)

    def _note(self, topic: str, message: RawMessage) -> None:
        self._messages.append((topic, time.monotonic(), message.data[:_START].hex()))

    def _take_transforms(self, message: RawMessage) -> None:
        read: Any = Transforms  # of a type that is not installed
        for each in transforms_of(read.read(message.data)):
            self._frames.setdefault(each.child.lstrip("/"), set()).add(each.parent.lstrip("/"))

    def _print(self) -> None:
        messages, self._messages = self._messages, []
        frames = {child: sorted(parents) for child, parents in self._frames.items()}
        sys.stdout.write(json.dumps({"messages": messages, "frames": frames}) + "\n")
        sys.stdout.flush()


if __name__ == "__main__":
    sys.exit(run("matrix_ears", EarsNode, own_terminal=True))
