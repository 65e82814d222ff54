"""Topics and services as the master knows them now."""

from __future__ import annotations

from dataclasses import dataclass, field

import rospy


@dataclass(frozen=True, slots=True)
class Topic:
    """A topic: its type ("" while no publisher has told it), and the nodes at its ends."""

    name: str
    kind: str = ""
    publishers: tuple[str, ...] = ()
    subscribers: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class RosGraph:
    """The topics by name, and the services."""

    topics: dict[str, Topic] = field(default_factory=dict)
    services: tuple[str, ...] = ()


def read_graph(own: str) -> RosGraph | None:
    """Ask the master, leaving out the node `own`; None while it does not answer."""
    try:
        master = rospy.get_master()
        published, subscribed, services = master.getSystemState()[2]
        kinds = {str(name): str(kind) for name, kind in master.getTopicTypes()[2]}
    except Exception:  # a master that does not answer has nothing now
        return None
    ends: dict[str, list[tuple[str, ...]]] = {}
    for side, found in enumerate((published, subscribed)):
        for name, nodes in found:
            others = tuple(sorted(str(each) for each in nodes if each != own))
            ends.setdefault(str(name), [(), ()])[side] = others
    topics = {
        name: Topic(name, kinds.get(name, "").replace("*", ""), *sides) for name, sides in ends.items() if any(sides)
    }
    return RosGraph(topics, tuple(sorted(str(name) for name, nodes in services if list(nodes) != [own])))
