from __future__ import annotations

import pytest
from tests.tui.fake import RUN, line

from ur.run.events import NodeChanged, NodeReadiness, NodeStats, RunEvent, RunStopping, StatsSampled
from ur.tui.board import Board, NodeRow, apply_events


@pytest.mark.parametrize(("changed", "mood", "word"), [
    (NodeChanged("/a", "waiting"), "idle", "waiting"),
    (NodeChanged("/a", "starting"), "busy", "starting"),
    (NodeChanged("/a", "running", pid=1), "busy", "coming up"),
    (NodeChanged("/a", "running", pid=1, core=True), "up", "up"),
    (NodeChanged("/a", "stopping", pid=1), "busy", "stopping"),
    (NodeChanged("/a", "ended", exit_code=0), "idle", "finished"),
    (NodeChanged("/a", "ended", exit_code=3), "failed", "exit 3"),
    (NodeChanged("/a", "ended", signal=11), "failed", "SIGSEGV"),
    (NodeChanged("/a", "ended", signal=64), "failed", "SIGRTMAX"),
    (NodeChanged("/a", "ended", signal=9, held=True), "idle", "stopped"),
    (NodeChanged("/a", "ended", reason="x: permission denied"), "failed", "not started"),
    (NodeChanged("/a", "waiting", exit_code=1, restart_in=4.2), "failed", "exit 1, again in 4 s"),
    (NodeChanged("/a", "waiting", exit_code=0, restart_in=4.2), "busy", "finished, again in 4 s"),
])  # fmt: skip
def test_state_in_a_word(changed: NodeChanged, mood: str, word: str) -> None:
    row = NodeRow(changed)
    assert (row.mood, row.word) == (mood, word)


def test_node_is_up_once_it_is_ready_and_not_after_a_restart() -> None:
    board = apply_events(Board(RUN), [NodeChanged("/a", "running", pid=1), NodeReadiness("/a", ready=True)])
    assert board.rows[0].word == "up"
    board = apply_events(board, [NodeChanged("/a", "running", pid=2, restarts=1)])
    assert board.rows[0].word == "coming up"


def test_remark_says_what_is_missing_before_what_was_printed() -> None:
    events: list[RunEvent] = [
        NodeChanged("/a", "running", pid=1),
        line("/a", "hello"),
        NodeReadiness("/a", False, ("no scan",)),
    ]
    assert apply_events(Board(RUN), events).rows[0].remark == "no scan"


def test_use_of_a_node_that_ended_is_not_shown() -> None:
    board = apply_events(Board(RUN), [NodeChanged("/a", "running", pid=1), StatsSampled((NodeStats("/a", 1.5, 9),))])
    assert (board.rows[0].cpu, board.rows[0].memory) == (1.5, 9)
    board = apply_events(board, [NodeChanged("/a", "ended", exit_code=0)])
    assert (board.rows[0].cpu, board.rows[0].memory) == (None, None)


def test_events_of_unknown_nodes_are_harmless() -> None:
    board = apply_events(Board(RUN), [NodeReadiness("/x", True), line("/x", "hello"), RunStopping("why")])
    assert board.rows == ()
    assert board.cause == "why"


def test_master_and_rosout_come_last_and_do_not_count() -> None:
    board = apply_events(Board(RUN), [NodeChanged("/m", "running", core=True), NodeChanged("/a", "ended", exit_code=1)])
    assert [row.name for row in board.rows] == ["/a", "/m"]
    assert board.count() == {"up": 0, "busy": 0, "failed": 1, "idle": 0}
