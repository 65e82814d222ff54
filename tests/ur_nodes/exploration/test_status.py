from dataclasses import replace

import pytest

from ur_nodes.exploration.status import ExploreStatus, describe_status, read_status, write_status

BLOCKED = ("behind the glass or through a gap at (1.00, 2.00)", "too narrow at (3.00, 4.00): 0.31 m < 0.46 m")


def test_status_survives_its_way_as_json() -> None:
    status = ExploreStatus("exploring", 3, 12.5, 40.0, 17.0, 65.0, BLOCKED, ("(1.00, 2.00)",), "", "/maps/flat.yaml")
    assert read_status(write_status(status)) == status
    assert read_status(write_status(replace(status, left=240.0))) == replace(status, left=240.0)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "3",
        "[]",
        "{}",
        '{"state": "gone", "unreachable": []}',
        '{"state": "exploring", "unreachable": [3]}',
        '{"state": "exploring", "unreachable": [], "way": "far"}',
        '{"state": "exploring", "unreachable": [], "left": "long"}',
        '{"state": "exploring", "unreachable": [], "left": Infinity}',
        '{"state": "exploring", "unreachable": [], "seconds": 1' + 400 * "0" + "}",
        '{"state": "exploring", "unreachable": [], "corners": [3]}',
        '{"state": "exploring", "unreachable": [], "more": 1}',
        '{"state": ["exploring"], "unreachable": []}',
    ],
)
def test_what_is_no_status_is_none(text: str) -> None:
    assert read_status(text) is None


def test_line_says_how_much_is_left() -> None:
    line = describe_status(ExploreStatus("exploring", 1, 12.4, 40.2, 17.3, 65.0))
    assert line == "40 m² known, 17 m driven in 1:05 min; 1 frontier left, about 12 m² unknown"


@pytest.mark.parametrize(("seconds", "words"), [(10.0, "about 1 min left"), (230.0, "about 4 min left")])
def test_line_says_how_long_it_will_take(seconds: float, words: str) -> None:
    line = describe_status(ExploreStatus("exploring", 1, 12.4, 40.2, 17.3, 65.0, left=seconds))
    assert line.endswith(f"1 frontier left, about 12 m² unknown, {words}")


def test_end_is_explained_with_what_cannot_be_reached() -> None:
    line = describe_status(ExploreStatus("complete", known=40.0, way=17.0, seconds=65.0, unreachable=BLOCKED))
    assert line == (
        "the map is complete: 0 frontiers reachable; 2 unreachable: behind the glass or through a gap at (1.00, 2.00), "
        "too narrow at (3.00, 4.00): 0.31 m < 0.46 m; 40 m² known, 17 m driven in 1:05 min"
    )


def test_end_names_the_corners_that_are_left_out() -> None:
    line = describe_status(ExploreStatus("complete", corners=("(1.00, 2.00)",), unreachable=BLOCKED))
    assert line.startswith(
        "the map is complete: 0 frontiers reachable; 1 corner left out: (1.00, 2.00); 2 unreachable: "
    )


def test_end_before_the_map_is_complete_says_why_and_what_is_left() -> None:
    line = describe_status(ExploreStatus("incomplete", 2, 8.0, reason="the robot does not move"))
    assert line.startswith("the map is not complete: the robot does not move; 2 frontiers left, about 8 m² unknown")


def test_long_lists_are_cut() -> None:
    line = describe_status(ExploreStatus("complete", unreachable=tuple(f"at ({number}, 0)" for number in range(9))))
    assert "9 unreachable: at (0, 0), at (1, 0), at (2, 0), at (3, 0), and 5 more" in line
