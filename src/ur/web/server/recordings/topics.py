"""Topics of a recording: those that a page has chosen, or all except images and point clouds."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Annotated

from msgspec import Meta

from ur.run.master.client import parse_master_uri
from ur.run.master.xml_rpc import WrongServer
from ur.source.foreign.json_values import ForeignValue

MOST_TOPICS = 40
"""Topics that a page may choose."""

_MOST_LEFT_OUT = 200
_NAME = r"^(/[A-Za-z][A-Za-z0-9_]{0,99}){1,10}\Z"
_LARGE = {
    "sensor_msgs/Image",
    "sensor_msgs/CompressedImage",
    "sensor_msgs/PointCloud",
    "sensor_msgs/PointCloud2",
    "stereo_msgs/DisparityImage",
    "theora_image_transport/Packet",
}
_LARGE_BY_NAME = r"(/.*)?/(image|points|cloud)[^/]*(/.*)?|/.*/(compressed|compressedDepth|theora)"


@dataclass(frozen=True, slots=True)
class PublishedTopic:
    """A published topic and its type."""

    name: str
    kind: str


@dataclass(frozen=True, slots=True)
class TopicSelection:
    """The recorded `topics`. If empty: all except those whose whole name matches the pattern `left_out`."""

    topics: tuple[str, ...] = ()
    left_out: str = ""


class ChosenTopics(ForeignValue, frozen=True):
    """The topics that a request names; None for all."""

    topics: (
        Annotated[
            tuple[Annotated[str, Meta(pattern=_NAME)], ...],
            Meta(min_length=1, max_length=MOST_TOPICS, description=f"1 to {MOST_TOPICS} full names, such as /scan"),
        ]
        | None
    ) = None

    @property
    def names(self) -> tuple[str, ...]:
        """Return each topic once."""
        return tuple(dict.fromkeys(self.topics or ()))


def is_topic(name: object) -> bool:
    """Return whether a value is a full topic name without characters that have a special meaning elsewhere."""
    return isinstance(name, str) and re.search(_NAME, name) is not None


def select(chosen: tuple[str, ...], published: Iterable[PublishedTopic]) -> TopicSelection:
    """Return the selection for the chosen topics; if there are none, all except large ones, also later ones."""
    if chosen:
        return TopicSelection(chosen)
    large = [each.name for each in published if each.kind in _LARGE][:_MOST_LEFT_OUT]
    return TopicSelection(left_out="|".join([*large, _LARGE_BY_NAME]))


def list_topics(master: str) -> tuple[PublishedTopic, ...]:
    """List the topics that are published at a master; this blocks.

    Raises Unanswered, CallRefused or UserError if there is no answer of a master.
    """
    found = parse_master_uri(master).call("getPublishedTopics", "")
    if not isinstance(found, list):
        raise WrongServer("expected the topics of a ROS master")
    pairs = [each for each in found if isinstance(each, list) and len(each) == 2]
    return tuple(PublishedTopic(name, str(kind)[:200]) for name, kind in sorted(pairs, key=str) if is_topic(name))
