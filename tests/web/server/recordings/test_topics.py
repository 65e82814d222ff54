"""Topics that may be recorded, and those that are left out."""

import pytest

from ur.source.foreign.json_values import convert_json
from ur.web.server.recordings.recording_pages import MOST_TOPICS, ChosenTopics, list_topics
from ur.web.wire.reading import BadRequestError


def read_topics(value: object) -> tuple[str, ...]:
    return convert_json({"topics": value}, ChosenTopics).names


@pytest.mark.parametrize(
    "name", ["scan", "", "/", "--all", "-O", "/a b", "/a;b", "/a/../b", "/a|b", "/$(x)", "/a\n", "/é", "/a//b", 1, None]
)
def test_topic_that_is_no_full_name_is_refused(name: object) -> None:
    with pytest.raises(BadRequestError, match="expected 1 to"):
        read_topics(["/scan", name])


@pytest.mark.parametrize("value", [[], "/scan", {"/scan": 1}, ["/a"] * (MOST_TOPICS + 1), 3, True])
def test_choice_that_is_no_short_list_is_refused(value: object) -> None:
    with pytest.raises(BadRequestError):
        read_topics(value)


def test_chosen_topics_are_recorded_once_each() -> None:
    assert read_topics(["/scan", "/robot/odom", "/scan"]) == ("/scan", "/robot/odom")


def test_no_topics_are_known_without_asking_on_ros_2() -> None:
    assert list_topics("ros2://localhost/5") == ()
