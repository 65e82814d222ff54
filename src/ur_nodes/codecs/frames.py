"""Transforms that are sent together, on /tf or /tf_static."""

import math
import time

from geometry_msgs.msg import TransformStamped

from ur_nodes.codecs.codec import Codec, fill_header
from ur_nodes.codecs.dialect import Transforms, stamp_of
from ur_nodes.codecs.geometry import pose3_of_transform
from ur_nodes.ports.values import Transform

_YOUNG = 1.0  # s


def fill_transforms(message: Transforms, value: tuple[Transform, ...]) -> None:
    """Write a tf2_msgs/TFMessage; its parts are used again."""
    parts = message.transforms
    del parts[len(value) :]
    parts += [TransformStamped() for _ in range(len(value) - len(parts))]
    for part, each in zip(parts, value, strict=True):
        fill_header(part, each.stamp, each.parent)
        part.child_frame_id = each.child
        place, turn = part.transform.translation, part.transform.rotation
        place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w = each.pose


def transforms_of(message: Transforms, *, fixed: bool = False) -> tuple[Transform, ...]:
    """Read a tf2_msgs/TFMessage; `fixed` is whether it arrived on /tf_static."""
    return tuple(
        Transform(
            stamp_of(each.header.stamp),
            each.header.frame_id.lstrip("/"),
            each.child_frame_id.lstrip("/"),
            pose3_of_transform(each.transform),
            fixed,
        )
        for each in message.transforms
    )


class Newest:
    """The moving transforms that were sent last, for new subscribers: a publisher's first message is lost."""

    def __init__(self) -> None:
        self._sent: tuple[float, tuple[Transform, ...]] = (-math.inf, ())

    def note(self, transforms: tuple[Transform, ...]) -> None:
        """Note transforms that are sent now."""
        self._sent = time.monotonic(), transforms

    def get(self) -> tuple[Transform, ...]:
        """Return the transforms sent in the last second, on any thread: older ones would look like frames at rest."""
        sent, transforms = self._sent
        return transforms if time.monotonic() - sent < _YOUNG else ()


CODECS = {tuple: Codec(Transforms, fill_transforms, transforms_of)}
