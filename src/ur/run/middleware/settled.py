"""The graph of a middleware whose nodes discover each other one by one."""

from __future__ import annotations

from ur.run.middleware.protocol import GraphView, RunGraph

PERIOD = 0.25  # s between two looks
_QUIET = 4  # looks without a change
_MOST = 40  # looks


def read_settled(view: GraphView) -> RunGraph:
    """Read the graph until it is unchanged for a second, at most for ten seconds. Raises NoGraph."""
    graph, quiet = view.look(()), 0
    for _ in range(_MOST):
        if quiet >= _QUIET and graph.topics():
            break
        view.wait(PERIOD)
        newer = view.look(())
        quiet = quiet + 1 if newer == graph else 0
        graph = newer
    view.forget()
    return graph
