import pytest
from tests.tui.fake import RUN, line

from ur.run.clients.protocol import NodeChanged, NodeReadiness, NodeStats, RunEvent, RunStopping, StatsSampled
from ur.run.clients.run_state import NodeRow, RunState, apply_events, begin_state, describe_node, list_missing
from ur.tui.palette import DARK
from ur.tui.run_screen import describe_run


@pytest.mark.parametrize(("changed", "mood", "word"), [
    (NodeChanged("/a", "waiting"), "idle", "waiting"),
    (NodeChanged("/a", "starting"), "busy", "starting"),
    (NodeChanged("/a", "running", pid=1), "busy", "not ready"),
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
    state = apply_events(RunState(RUN), [NodeChanged("/a", "running", pid=1), NodeReadiness("/a", ready=True)])
    assert state.rows[0].word == "up"
    state = apply_events(state, [NodeChanged("/a", "running", pid=2, restarts=1)])
    assert state.rows[0].word == "not ready"


def test_remark_says_what_is_missing_before_what_was_printed() -> None:
    events: list[RunEvent] = [
        NodeChanged("/a", "running", pid=1),
        line("/a", "hello"),
        NodeReadiness("/a", False, ("no scan",)),
    ]
    assert apply_events(RunState(RUN), events).rows[0].remark == "no scan"


@pytest.mark.parametrize(
    "noise",
    [
        "[rospack] Error: no such package media_export",
        "[librospack]: error while executing command",
        "QStandardPaths: XDG_RUNTIME_DIR not set, defaulting to '/tmp/runtime-root'",
        "active samplers with a different type refer to the same texture image unit\x1b[0m",
    ],
)
def test_noise_of_rviz_is_no_remark(noise: str) -> None:
    events: list[RunEvent] = [
        NodeChanged("/rviz", "running", pid=1),
        NodeReadiness("/rviz", True),
        line("/rviz", "Stereo is NOT SUPPORTED"),
        line("/rviz", noise),
    ]
    assert apply_events(RunState(RUN), events).rows[0].remark == "Stereo is NOT SUPPORTED"


def test_use_of_a_node_that_ended_is_not_shown() -> None:
    state = apply_events(RunState(RUN), [NodeChanged("/a", "running", pid=1), StatsSampled((NodeStats("/a", 1.5, 9),))])
    assert (state.rows[0].cpu, state.rows[0].memory) == (1.5, 9)
    state = apply_events(state, [NodeChanged("/a", "ended", exit_code=0)])
    assert (state.rows[0].cpu, state.rows[0].memory) == (None, None)


def test_events_of_unknown_nodes_are_harmless() -> None:
    state = apply_events(RunState(RUN), [NodeReadiness("/x", True), line("/x", "hello"), RunStopping("why")])
    assert state.rows == ()
    assert state.cause == "why"


def test_master_and_rosout_come_last_and_do_not_count() -> None:
    state = apply_events(
        RunState(RUN), [NodeChanged("/m", "running", core=True), NodeChanged("/a", "ended", exit_code=1)]
    )
    assert [row.name for row in state.rows] == ["/a", "/m"]
    assert state.count() == {"up": 0, "busy": 0, "failed": 1, "idle": 0}


@pytest.mark.parametrize(("end", "mood", "word"), [
    (NodeChanged("/a", "ended", signal=2), "idle", "stopped"),
    (NodeChanged("/a", "ended", exit_code=143), "idle", "stopped"),
    (NodeChanged("/a", "ended", signal=9), "failed", "SIGKILL"),
    (NodeChanged("/a", "ended", signal=11), "failed", "SIGSEGV"),
    (NodeChanged("/a", "ended", exit_code=1), "failed", "exit 1"),
])  # fmt: skip
def test_node_that_ends_as_it_was_asked_to_has_not_failed(end: NodeChanged, mood: str, word: str) -> None:
    state = apply_events(
        RunState(RUN), [NodeChanged("/a", "running", pid=1), NodeChanged("/a", "stopping", pid=1), end]
    )
    assert (state.rows[0].mood, state.rows[0].word) == (mood, word)
    state = apply_events(RunState(RUN), [NodeChanged("/a", "running", pid=1), end])
    assert state.rows[0].mood == "failed"


def test_nodes_that_end_with_the_run_are_stopping_not_starting() -> None:
    events: list[RunEvent] = [NodeChanged("/a", "stopping", pid=1), RunStopping("Ctrl-C")]
    line_ = describe_run(apply_events(RunState(RUN), events), 0.0, 100, DARK).plain
    assert "1 stopping" in line_
    assert "starting" not in line_


@pytest.mark.parametrize(
    ("node", "text"),
    [
        (NodeChanged("/a", "running", pid=7), "running, process 7"),
        (NodeChanged("/a", "waiting", restart_in=3.0, restarts=2), "starts again in 3 s, restarted 2 times"),
        (NodeChanged("/a", "ended", held=True), "stopped by hand"),
        (NodeChanged("/a", "ended", reason="no such file"), "ended: no such file"),
    ],
)
def test_state_of_a_node_is_described(node: NodeChanged, text: str) -> None:
    assert describe_node(node) == text


def missing_after(*events: RunEvent) -> dict[str, tuple[str, ...]]:
    return list_missing(apply_events(begin_state(), events))


def test_node_is_missing_until_it_is_up_or_has_done_its_work() -> None:
    events: list[RunEvent] = [
        NodeChanged("/master", "running", core=True),
        NodeReadiness("/unknown", ready=False, missing=("x",)),
    ]
    assert missing_after(*events) == {}
    events.append(NodeChanged("/a", "running", pid=7))
    assert missing_after(*events) == {"/a": ("it is not looked at yet",)}
    assert missing_after(*events, NodeReadiness("/a", ready=False, missing=("no scan",))) == {"/a": ("no scan",)}
    assert missing_after(*events, NodeReadiness("/a", ready=True)) == {}
    assert missing_after(*events, NodeChanged("/a", "ended", exit_code=0)) == {}


def test_node_that_does_not_run_is_missing_with_its_state_and_log() -> None:
    missing = missing_after(NodeChanged("/a", "waiting", restart_in=2.0, log="/tmp/a.log"))
    assert missing == {"/a": ("it does not run: starts again in 2 s (log: /tmp/a.log)",)}
