import re
import threading

import pytest
from tests.tui.fake import RUN, FakeRun, example, line

from ur.run.clients.protocol import LinkChanged, NodeChanged, NodeReadiness, Notice, RunEnded, RunEvent, RunStopping
from ur.run.clients.run_state import RunState, apply_events
from ur.tui.status_line import describe_status, show_events, show_status_line

COLOUR = re.compile("\x1b\\[[0-9;]*m")


def bare(text: str) -> str:
    return COLOUR.sub("", text)


def test_line_counts_nodes_and_names_the_first_that_is_not_up() -> None:
    state = apply_events(RunState(RUN), example())
    assert bare(describe_status(state, 100)) == "m_map  1 up  1 starting  2 failed  1 off  camera: exit 1"


@pytest.mark.parametrize("width", range(1, 70))
def test_line_never_reaches_the_last_column(width: int) -> None:
    assert len(bare(describe_status(apply_events(RunState(RUN), example()), width))) < width


def test_line_says_that_the_run_stops() -> None:
    state = apply_events(RunState(RUN), [NodeChanged("/a", "running"), RunStopping("Ctrl-C")])
    assert bare(describe_status(state, 80)) == "m_map  stopping  1 starting"


def test_line_says_that_the_link_to_the_robot_is_lost_until_it_is_restored() -> None:
    state = apply_events(RunState(RUN), [NodeChanged("/a", "running"), LinkChanged("bob", lost=True, seconds=1.2)])
    assert bare(describe_status(state, 80)) == "m_map  no word from bob for 1.2 s  1 starting  a: not ready"
    state = apply_events(state, [LinkChanged("bob", lost=True, seconds=1.7)])
    assert "for 1.7 s" in bare(describe_status(state, 80))
    state = apply_events(state, [LinkChanged("bob", lost=False, seconds=2.0)])
    assert bare(describe_status(state, 80)) == "m_map  1 starting  a: not ready"


def test_only_what_matters_stays() -> None:
    happened: list[RunEvent] = [
        NodeChanged("/a", "running", pid=1),
        NodeReadiness("/a", True),
        line("/a", "[ INFO] [1.0]: fine"),
        line("/a", "[ WARN] [1.0]: low\x1b[2J"),
        Notice("info", "started"),
        Notice("error", "died\n  log: x"),
    ]
    _, shown = show_events(RunState(RUN), happened, 80)
    assert [bare(text) for text in shown.lines] == ["[/a] [ WARN] [1.0]: low?[2J", "died", "  log: x"]


def test_run_is_watched_to_its_end() -> None:
    run = FakeRun()
    written: list[str] = []
    try:
        run.tell(*example(), RunEnded(0))
        assert show_status_line(run.control, written.append) == ("ended", 0)
        assert "camera died" in "".join(written)
        assert written[-1] == "\r\x1b[K"
    finally:
        run.close()


def test_run_that_is_killed_ends_it_too() -> None:
    run = FakeRun()
    threading.Timer(0.05, run.go).start()
    try:
        assert show_status_line(run.control, lambda _: None) == ("killed", 1)
    finally:
        run.close()


def test_calm_line_has_no_colours_where_they_are_not_wanted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NO_COLOR", "1")
    run = FakeRun()
    written: list[str] = []
    try:
        run.tell(*example(), RunEnded(0))
        assert show_status_line(run.control, written.append) == ("ended", 0)
        assert "camera died" in "".join(written)
        assert not re.search(r"\x1b\[[0-9;]*m", "".join(written))
    finally:
        run.close()
