from pathlib import Path

import pytest

from ur.source.diagnostic import UserError
from ur_nodes.memory.bus import Bus
from ur_nodes.ports.parameters import Parameters
from ur_nodes.vision.fiducial_parameters import parse_numbers, parse_sizes, read_sizes, read_slam_settings


def parameters(**values: object) -> Parameters:
    bus = Bus()
    bus.load_parameters("/fiducials", values)
    return bus.node("fiducials").parameters


def test_sizes_are_read_from_their_texts() -> None:
    sizes = read_sizes(parameters(fiducial_len=0.3, fiducial_len_override="3: 0.2, 7-8: 0.1", ignore_fiducials="9"))
    assert sizes.usual == 0.3
    assert sizes.special == {3: 0.2, 7: 0.1, 8: 0.1}
    assert 9 in sizes.ignored


def test_frames_and_the_map_have_the_defaults_of_upstream() -> None:
    settings = read_slam_settings(parameters())
    assert (settings.map_frame, settings.odom_frame, settings.base_frame) == ("map", "odom", "base_footprint")
    assert settings.map_file == Path.home() / ".ros/slam/map.txt"


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("fiducial_len_override", "big", "expected numbers and sizes in m"),
        ("ignore_fiducials", "all", "expected numbers, such as"),
        ("fiducial_len", 0, "expected a number from 0.005 to 10"),
    ],
)
def test_parameter_that_cannot_be_is_refused(name: str, value: object, message: str) -> None:
    with pytest.raises(UserError, match=f"parameter /fiducials/{name}: {value!r}, {message}"):
        read_sizes(parameters(**{name: value}))


def test_numbers_and_ranges_are_read() -> None:
    assert parse_numbers("") == frozenset()
    assert parse_numbers(" 3, 7-9 ,") == {3, 7, 8, 9}


def test_sizes_are_read_for_numbers_and_ranges() -> None:
    assert parse_sizes("3: 0.2, 7-8:0.1") == {3: 0.2, 7: 0.1, 8: 0.1}


@pytest.mark.parametrize("text", ["3", "3: 0", "3: -1", "x: 0.2", "3: wide", "1-: 0.2"])
def test_sizes_that_are_none_are_refused(text: str) -> None:
    with pytest.raises(ValueError, match=r".+"):
        parse_sizes(text)
