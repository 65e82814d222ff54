"""Topics that the black box records, and how often."""

from ur_nodes.ports.graph import Graph, Topic
from ur_nodes.ports.raw import RecordedTopic

MOST_TOPICS = 500

PICTURE_PERIOD = 1.0
"""Seconds from one picture or cloud to the next."""

_CAMERA_INFO = "CameraInfo"
_SELDOM = frozenset(
    {"Image", "CompressedImage", _CAMERA_INFO, "PointCloud", "PointCloud2", "DisparityImage", "CompressedPointCloud2"}
)
_STREAM = "Packet"  # of a film, of which one picture in many cannot be shown
_PACKED = ("/compressed", "/compressedDepth")


def select_topics(graph: Graph, wake: bool, large: frozenset[str] = frozenset()) -> tuple[RecordedTopic, ...]:
    """Select at most MOST_TOPICS topics of a graph, sorted by name.

    Pictures and clouds, and the topics in `large`, are recorded once a second. Without `wake` they are taken only while
    another node subscribes to them, since cameras and their drivers do nothing before. A raw picture is left out where
    it is published compressed, too, and the log of all nodes where each of them publishes its own.
    """
    topics = [each for each in graph.topics.values() if each.publishers]
    names = {each.name for each in topics}
    chosen = []
    for each in topics:
        kind = each.kind.rpartition("/")[2]
        if kind == _STREAM or (each.name == "/rosout_agg" and "/rosout" in names):
            continue
        if kind == "Image" and _has_packed(each, names):
            continue
        if kind in _SELDOM and not wake and not each.subscribers:
            continue
        period = PICTURE_PERIOD if kind in _SELDOM or each.name in large else 0.0
        chosen.append(RecordedTopic(each.name, each.publishers, period, each.kind))
    return tuple(chosen)


def _has_packed(topic: Topic, names: set[str]) -> bool:
    # image_transport adds to the whole name, raspicam_node to the one of the camera's pictures
    return any(f"{stem}{each}" in names for each in _PACKED for stem in (topic.name, topic.name.removesuffix("_raw")))
