from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

import pytest

from ur.cli.runs.logs import LogFollower
from ur.run.output.log_rotation import drop_beginning


@pytest.fixture
def log(tmp_path: Path) -> Iterator[tuple[BinaryIO, LogFollower, str]]:
    path = tmp_path / "a.log"
    with path.open("ab", buffering=0) as writer, path.open("rb") as reader:
        yield writer, LogFollower(reader.fileno()), str(path)


def lines(first: int, last: int) -> bytes:
    return b"".join(b"line %d\n" % number for number in range(first, last))


def test_follower_returns_what_was_appended(log: tuple[BinaryIO, LogFollower, str]) -> None:
    writer, follower, _ = log
    assert follower.read() == b""
    writer.write(lines(0, 3))
    assert follower.read() == lines(0, 3)
    assert follower.read() == b""
    writer.write(lines(3, 5))
    assert follower.read() == lines(3, 5)


def test_follower_continues_after_the_beginning_was_removed(log: tuple[BinaryIO, LogFollower, str]) -> None:
    writer, follower, path = log
    writer.write(lines(0, 10_000))
    follower.read()
    assert drop_beginning(path, 20_000)
    assert follower.read() == b""
    writer.write(lines(10_000, 10_003))
    assert follower.read() == lines(10_000, 10_003)


def test_follower_notices_a_file_that_was_cut_and_grew_beyond_its_position(
    log: tuple[BinaryIO, LogFollower, str],
) -> None:
    writer, follower, path = log
    writer.write(lines(0, 10_000))
    follower.read()
    assert drop_beginning(path, 20_000)
    writer.write(lines(10_000, 40_000))
    assert follower.read() == lines(10_000, 40_000)


def test_follower_returns_the_whole_file_where_what_it_read_was_removed(
    log: tuple[BinaryIO, LogFollower, str],
) -> None:
    writer, follower, path = log
    writer.write(lines(0, 10_000))
    follower.read()
    writer.write(lines(10_000, 40_000))
    assert drop_beginning(path, 20_000)
    data = follower.read()
    assert data == Path(path).read_bytes()
    assert data.endswith(lines(39_000, 40_000))
