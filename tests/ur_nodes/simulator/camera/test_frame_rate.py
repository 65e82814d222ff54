from collections.abc import Iterator

from hypothesis import given
from hypothesis import strategies as st

from ur_nodes.simulator.camera.camera_topics import FrameCount


def notes(count: FrameCount, rate: float, seconds: float, every: int, start: float = 0.0) -> Iterator[str]:
    """What is said while one of `every` pictures is made."""
    for number in range(round(rate * seconds)):
        said = count.note(start + number / rate, made=number % every == 0)
        if said:
            yield said


def test_shortfall_is_said_once_with_the_rate_that_is_reached() -> None:
    said = list(notes(FrameCount(90.0), 90.0, 60.0, every=3))
    assert len(said) == 1
    assert "makes 30 of the 90 pictures a second" in said[0]


@given(rate=st.floats(1.0, 200.0))
def test_rate_that_is_reached_is_not_mentioned(rate: float) -> None:
    assert not list(notes(FrameCount(rate), rate, 30.0, every=1))


def test_slow_start_is_not_mentioned() -> None:
    count = FrameCount(20.0)
    assert not list(notes(count, 20.0, 4.0, every=80))
    assert not list(notes(count, 20.0, 30.0, every=1, start=4.0))


def test_time_in_which_nobody_looks_does_not_count() -> None:
    count = FrameCount(20.0)
    for begin in range(0, 600, 60):
        assert not list(notes(count, 20.0, 12.0, every=1, start=float(begin)))
