"""The guard process on a pseudo-terminal: what the boards' motors get when the process of the driver dies or stalls."""

from __future__ import annotations

import os
import signal
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
