from typing import Any

from ur.run.clients.protocol import (
    LinkChanged,
    NodeChanged,
    NodeReadiness,
    NodeStats,
    RunEvent,
    RunStopping,
    StatsSampled,
    Synchronised,
)
from ur.run.clients.run_state import apply_events, begin_state
from ur.run.record.registry import EndedRun, RunEntry
from ur.web.runs.watcher import MOST_ENDED, describe_runs

ENTRY = RunEntry("demo.7", 7, 1, "demo", "http://localhost:11311", "/secret/log", 100.0, True, "here", "/secret/run")
RUNNING = NodeChanged("/talk", "running", pid=8, log="/secret/talk.log", program="/secret/talk")


def show(*events: RunEvent) -> dict[str, Any]:
    shown: Any = describe_runs([(ENTRY, apply_events(begin_state(), events))], ())
    (run,) = shown["runs"]
    return dict(run)


def test_node_is_shown_with_state_readiness_and_use() -> None:
    used = StatsSampled((NodeStats("/talk", 0.25, 1000), NodeStats("/other", 1.0, 1)))
    run = show(RUNNING, NodeReadiness("/talk", False, ("no topic",)), used, Synchronised())
    (node,) = run["nodes"]
    assert (node["name"], node["state"], node["pid"]) == ("/talk", "running", 8)
    assert (node["ready"], node["missing"], node["cpu"], node["memory"]) == (False, ["no topic"], 0.25, 1000)
    assert run["known"]


def test_paths_of_this_computer_are_not_shown() -> None:
    assert "/secret" not in str(show(RUNNING, Synchronised()))


def test_another_process_of_a_node_begins_anew() -> None:
    ready = NodeReadiness("/talk", True)
    again = NodeChanged("/talk", "running", pid=9, restarts=1)
    (node,) = show(RUNNING, ready, again)["nodes"]
    assert (node["ready"], node["cpu"], node["restarts"]) == (False, None, 1)


def test_run_tells_why_it_ends_and_whether_its_robot_is_lost() -> None:
    run = show(RUNNING, LinkChanged("bob", True, 2.5), RunStopping("asked"))
    assert (run["lost"], run["stopping"]) == (2.5, "asked")
    assert show(RUNNING, LinkChanged("bob", True, 2.5), LinkChanged("bob", False, 3.0))["lost"] is None


def test_latest_ended_runs_come_first() -> None:
    ended = [EndedRun(ENTRY, float(at), 1, "failed", ("line",)) for at in range(MOST_ENDED + 2)]
    shown: Any = describe_runs([], ended)
    found = shown["ended"]
    assert [each["ended"] for each in found] == [6.0, 5.0, 4.0, 3.0, 2.0]
    assert (found[0]["cause"], found[0]["lines"]) == ("failed", ["line"])
