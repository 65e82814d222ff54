"""The topics that the black box records."""

from ur_nodes.black_box.black_box import PICTURE_PERIOD, select_topics
from ur_nodes.ports.graph import Graph, Topic


def select(*topics: Topic, wake: bool = True, large: frozenset[str] = frozenset()) -> dict[str, float]:
    return {each.name: each.period for each in select_topics(Graph({each.name: each for each in topics}), wake, large)}


def topic(name: str, kind: str, *subscribers: str) -> Topic:
    return Topic(name, kind, ("/robot",), subscribers)


def test_pictures_and_clouds_are_taken_once_a_second() -> None:
    found = select(topic("/odom", "nav_msgs/Odometry"), topic("/points", "sensor_msgs/msg/PointCloud2"))
    assert found == {"/odom": 0.0, "/points": PICTURE_PERIOD}


def test_raw_picture_is_left_out_where_it_is_published_compressed() -> None:
    for twin in ("/camera/image_raw/compressed", "/camera/image/compressed"):
        raw, packed = topic("/camera/image_raw", "sensor_msgs/Image"), topic(twin, "sensor_msgs/CompressedImage")
        assert select(raw, packed) == {twin: PICTURE_PERIOD}
        assert select(raw) == {"/camera/image_raw": PICTURE_PERIOD}


def test_film_and_a_second_log_are_left_out() -> None:
    film = topic("/camera/image_raw/theora", "theora_image_transport/Packet")
    logs = topic("/rosout", "rosgraph_msgs/Log"), topic("/rosout_agg", "rosgraph_msgs/Log")
    assert select(film, *logs) == {"/rosout": 0.0}
    assert select(logs[1]) == {"/rosout_agg": 0.0}


def test_camera_is_not_made_to_work_for_the_black_box_alone() -> None:
    picture, info = "/camera/image/compressed", "/camera/camera_info"
    kinds = {picture: "sensor_msgs/CompressedImage", info: "sensor_msgs/CameraInfo"}
    assert select(*(topic(name, kind) for name, kind in kinds.items()), wake=False) == {}
    assert set(select(*(topic(name, kind, "/page") for name, kind in kinds.items()), wake=False)) == set(kinds)


def test_topic_of_large_messages_is_taken_once_a_second() -> None:
    assert select(topic("/blob", "std_msgs/String"), large=frozenset({"/blob"})) == {"/blob": PICTURE_PERIOD}


def test_topic_without_a_publisher_is_left_out() -> None:
    assert select(Topic("/odom", "nav_msgs/Odometry", (), ("/box",))) == {}
