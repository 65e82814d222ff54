from __future__ import annotations

import pytest

from ur.run.clients.node_view import ReadinessView, describe_node
from ur.run.clients.protocol import NodeChanged, NodeReadiness, RunStopping


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


def test_node_is_missing_until_it_is_up_or_has_done_its_work() -> None:
    view = ReadinessView()
    view.take(NodeChanged("/master", "running", core=True))
    view.take(NodeReadiness("/unknown", ready=False, missing=("x",)))
    assert view.list_missing() == {}
    view.take(NodeChanged("/a", "running", pid=7))
    assert view.list_missing() == {"/a": ("it is not looked at yet",)}
    view.take(NodeReadiness("/a", ready=True))
    assert view.list_missing() == {}
    view.take(NodeChanged("/a", "ended", exit_code=0))
    assert view.list_missing() == {}


def test_node_that_does_not_run_is_missing_with_its_state_and_log() -> None:
    view = ReadinessView()
    view.take(NodeChanged("/a", "waiting", restart_in=2.0, log="/tmp/a.log"))
    assert view.list_missing() == {"/a": ("it does not run: starts again in 2 s (log: /tmp/a.log)",)}
    view.take(RunStopping("required node /b ended"))
    assert view.cause == "required node /b ended"
