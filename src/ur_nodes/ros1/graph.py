"""The graph of ROS 1, as the master knows it."""

from __future__ import annotations

from typing import Any

import rosgraph

from ur_nodes.ports.graph import Ends, Graph, make_graph


def read_graph(name: str) -> Graph | None:
    """Ask the master, in the name of a node; None while it does not answer, or answers with something else."""
    master = rosgraph.Master(name)
    try:
        published, subscribed, services = (_ends(each) for each in master.getSystemState())
        kinds = {str(topic): str(kind).replace("*", "") for topic, kind in master.getTopicTypes()}
    except Exception:  # of the network, of XML-RPC and its parser, or of what is no graph
        return None
    return make_graph(published, subscribed, kinds, services)


def _ends(found: Any) -> Ends:
    return {str(name): tuple(map(str, nodes)) for name, nodes in found}
