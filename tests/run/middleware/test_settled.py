"""Graphs that are read until nothing changes any more."""

from collections.abc import Collection

from ur.cli.files.graph import read_settled
from ur.run.middleware.protocol import ReceivedMessages, RunGraph

NOTHING = RunGraph({}, {}, {})
ONE = RunGraph({"/scan": ["/lidar"]}, {}, {})
TWO = RunGraph({"/scan": ["/lidar"]}, {"/scan": ["/amcl"]}, {})


class GrowingView:
    """Shows one graph after the other; the last one stays."""

    def __init__(self, *graphs: RunGraph) -> None:
        self.received: dict[str, ReceivedMessages] = {}
        self._graphs = list(graphs)
        self.looks = 0
        self.forgotten = False

    def look(self, topics: Collection[str]) -> RunGraph:
        assert not topics
        self.looks += 1
        return self._graphs.pop(0) if len(self._graphs) > 1 else self._graphs[0]

    def wait(self, seconds: float) -> None:
        assert seconds > 0.0

    def forget(self) -> None:
        self.forgotten = True


def test_graph_is_read_until_all_nodes_were_discovered() -> None:
    view = GrowingView(NOTHING, NOTHING, ONE, ONE, ONE, TWO)
    assert read_settled(view) == TWO
    assert view.forgotten


def test_graph_that_stays_empty_is_given_up_after_a_while() -> None:
    view = GrowingView(NOTHING)
    assert read_settled(view) == NOTHING
    assert view.looks > 20
