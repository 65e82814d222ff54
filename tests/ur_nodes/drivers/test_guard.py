"""The guard process on a pseudo-terminal: what the boards' motors get when the process of the driver dies or stalls."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path

import pytest
from tests.ur_nodes.drivers.guarded import GuardedBoard

from ur_nodes.drivers.boards import BOARDS


@pytest.mark.parametrize("name", sorted(BOARDS))
def test_motors_stop_when_the_driver_stalls_or_is_killed_and_not_before(name: str, tmp_path: Path) -> None:
    with GuardedBoard(name, tmp_path / "device") as board:
        board.run_until(lambda: len(board.turned) > 10)
        assert all(speeds != (0.0, 0.0) for speeds in board.turned[2:])
        for sent in (signal.SIGSTOP, signal.SIGKILL):
            os.kill(board.driver.pid, sent)
            board.run_until(lambda: board.turned[-1] == (0.0, 0.0))
            os.kill(board.driver.pid, signal.SIGCONT)
            if sent is signal.SIGSTOP:
                board.run_until(lambda: board.turned[-1] != (0.0, 0.0))


def measure(count: int, folder: Path) -> None:
    """Print how long motors turn after the driver was killed or stopped: python -m tests.ur_nodes.drivers.test_guard."""
    for name in sorted(BOARDS):
        for sent in (signal.SIGKILL, signal.SIGSTOP):
            times = []
            for _ in range(count):
                with GuardedBoard(name, folder / "device") as board:
                    board.run_until(lambda board=board: len(board.turned) > 10)  # type: ignore[misc]
                    begun = time.monotonic()
                    os.kill(board.driver.pid, sent)
                    board.run_until(lambda board=board: board.turned[-1] == (0.0, 0.0))  # type: ignore[misc]
                    times.append(time.monotonic() - begun)
            print(f"{name} {sent.name}: {count} times, at most {max(times):.3f} s, median {sorted(times)[count // 2]:.3f} s")


if __name__ == "__main__":
    import sys
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        measure(int(sys.argv[1]), Path(folder))
