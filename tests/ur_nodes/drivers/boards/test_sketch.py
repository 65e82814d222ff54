"""The sketch ur_base, compiled for this computer, behind the driver of an Arduino."""

import math
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest
from tests.base_contract import PACKAGE, load

from ur_nodes.drivers.boards.arduino import Arduino, make_line
from ur_nodes.drivers.readings import Contacts, Counts, DeviceIdentity, Motors, Reading

pytestmark = pytest.mark.skipif(shutil.which("g++") is None, reason="needs g++")
SKETCH = PACKAGE / "n_base_driver" / "arduino" / "ur_base"
TURN = 360.0  # counts


@pytest.fixture(scope="module")
def sketch(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The program."""
    here, program = Path(__file__).parent, tmp_path_factory.mktemp("sketch") / "sketch"
    options = ["-std=c++11", "-Wall", "-Wextra", "-Werror", f"-I{SKETCH}", f"-I{here}"]
    subprocess.run(["g++", *options, str(here / "sketch_host.cpp"), "-o", str(program)], check=True, timeout=120)
    return program


def make_board() -> Arduino:
    base = load("create2", "")
    return Arduino(replace(base, odometry=replace(base.odometry, ticks_per_turn=int(TURN))))


def run(sketch: Path, steps: list[tuple[int, bytes]]) -> tuple[list[Reading], list[tuple[int, int, int]]]:
    """Give the sketch bytes at times (ms); return what the driver reads, and the powers of the motors then."""
    script = "".join(f"{ms} {data.hex() or '-'}\n" for ms, data in steps)
    output = subprocess.run([str(sketch)], input=script.encode(), stdout=subprocess.PIPE, check=True, timeout=60).stdout
    board, lines = make_board(), output.splitlines(keepends=True)
    readings = [each for line in lines for each in board.receive(line)]
    powers = [tuple(map(int, line.split()[1:])) for line in lines if line.startswith(b"motors")]
    return readings, powers  # type: ignore[return-value]


def drive(left: float, right: float, until: int, begin: int = 0) -> list[tuple[int, bytes]]:
    board = make_board()
    return [(ms, board.drive(left, right)) for ms in range(begin, until, 40)]


def test_sketch_names_itself_as_the_driver_expects(sketch: Path) -> None:
    readings, _ = run(sketch, [(10, make_board().handshake()), (30, b"")])
    assert [each for each in readings if isinstance(each, DeviceIdentity)] == [
        DeviceIdentity("sketch of ubiquity_launches")
    ]
    assert Motors(True) in readings
    assert any(isinstance(each, Contacts) for each in readings)


@pytest.mark.parametrize(("left", "right"), [(0.2, 0.2), (-0.2, 0.1), (0.05, -0.25)])
def test_wheels_turn_at_the_speed_that_was_asked_for(sketch: Path, left: float, right: float) -> None:
    readings, _ = run(sketch, drive(left, right, 4000))
    counts = [each for each in readings if isinstance(each, Counts)]
    begun, ended = counts[len(counts) // 2], counts[-1]
    metre = TURN / (2.0 * math.pi * 0.036)
    seconds = (len(counts) - 1 - len(counts) // 2) * 0.02
    speeds = [(b - a) / metre / seconds for a, b in ((begun.left, ended.left), (begun.right, ended.right))]
    assert speeds == pytest.approx([left, right], rel=0.03)


def test_motors_stop_150_ms_after_the_last_command_and_at_once_when_told_to(sketch: Path) -> None:
    driven = drive(0.2, 0.2, 1000)
    _, powers = run(sketch, [*driven, (1100, b""), (1115, b"")])
    assert powers[-2][1] > 0
    assert powers[-1][1:] == (0, 0)
    _, powers = run(sketch, [*driven, (1000, make_board().stop()), (1001, b"")])
    assert powers[-1][1:] == (0, 0)


def test_damaged_and_unknown_lines_move_nothing(sketch: Path) -> None:
    good = make_line("v 500 500")
    texts = ("v 500", "v 5x 500", "w 5 5", "v 500 500 5")
    bad = [good[:-2] + b"?\n", b"v 500 500\n", b"v 500 500*\n", b"v" * 300 + good, bytes(range(256))]
    bad += [make_line(text) for text in texts]
    for line in bad:
        _, powers = run(sketch, [(10, line), (60, b"")])
        assert powers[-1][1:] == (0, 0), line
    readings, powers = run(sketch, [(10, b"v" * 300 + b"\n" + good), (60, b"")])
    assert powers[-1][1] > 0
    assert readings
