import fcntl
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import ur.run.output.log_rotation as log_cut
from ur.run.output.log_rotation import MARK, drop_beginning

WRITER = """
import itertools, os
for number in itertools.count():
    os.write(1, b"%06d 0123456789 0123456789\\n" % number)
"""


Collapse = Callable[[int, int], bool] | None


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "a.log"


both_ways = pytest.mark.parametrize("collapse", [None, lambda *_: False], ids=["blocks", "copy"])


@both_ways
def test_newest_lines_stay_after_a_mark_and_writers_go_on(file: Path, collapse: Collapse) -> None:
    with file.open("ab", buffering=0) as log:
        for number in range(20_000):
            log.write(b"%06d 0123456789\n" % number)
        before = file.stat()
        removed = drop_beginning(str(file), 100_000, collapse)
        assert removed % 4096 == 0
        assert file.stat().st_ino == before.st_ino
        assert 100_000 <= file.stat().st_size == before.st_size - removed < 110_000
        log.write(b"after\n")
    first, *lines = file.read_bytes().splitlines()
    assert first.rstrip() == MARK
    assert lines[-1] == b"after"
    numbers = [int(line.split()[0]) for line in lines[:-1]]
    assert numbers == list(range(numbers[0], 20_000))


def test_process_that_appends_meanwhile_loses_nothing_where_blocks_can_be_removed(tmp_path: Path) -> None:
    file = tmp_path / "a.log"
    file.write_bytes(bytes(8192))
    with file.open("r+b") as probe:
        if not log_cut._collapse(probe.fileno(), 4096):
            pytest.skip("this file system removes no blocks")
    os.truncate(file, 0)
    cuts = 0
    with file.open("ab") as log, subprocess.Popen([sys.executable, "-c", WRITER], stdout=log) as writer:
        while cuts < 3 and writer.poll() is None:
            cuts += drop_beginning(str(file), 20_000) > 0
        writer.terminate()
    assert cuts == 3
    numbers = [int(line.split()[0]) for line in file.read_bytes().splitlines() if not line.startswith(MARK)]
    assert numbers == list(range(numbers[0], numbers[0] + len(numbers)))


@both_ways
def test_file_without_line_breaks_is_cut_without_a_mark(file: Path, collapse: Collapse) -> None:
    file.write_bytes(bytes(range(256)).replace(b"\n", b"") * 400)
    end = file.read_bytes()[-10_000:]
    assert drop_beginning(str(file), 10_000, collapse) > 0
    assert file.read_bytes().endswith(end)


def test_links_and_files_that_are_being_cut_are_left_alone(tmp_path: Path) -> None:
    target = tmp_path / "precious"
    target.write_bytes(bytes(50_000))
    link = tmp_path / "a.log"
    link.symlink_to(target)
    os.mkfifo(tmp_path / "pipe.log")
    assert drop_beginning(str(link), 0) == 0
    assert drop_beginning(str(tmp_path / "pipe.log"), 0) == 0
    assert drop_beginning(str(tmp_path / "missing.log"), 0) == 0
    with target.open("rb") as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        assert drop_beginning(str(target), 0) == 0
    assert target.stat().st_size == 50_000
