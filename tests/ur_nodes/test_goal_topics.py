"""Clients and servers of goals over topics, on a bus."""

from ur_nodes.client.navigation import Names, NavigationTopics
from ur_nodes.goal_topics import TopicGoalClient
from ur_nodes.memory.bus import Bus
from ur_nodes.ports.actions import Goal
from ur_nodes.ports.qualities import Quality


def test_client_has_a_server_once_one_is_among_the_listeners() -> None:
    bus, connected = Bus(), list[bool]()
    follower = NavigationTopics(bus.node("follower"), Names())
    client = TopicGoalClient(bus.node("client"), "move_base", follower, lambda: connected[-1])
    assert client.servers() == 0
    bus.node("recorder").subscribe("move_base/goal", Goal, lambda _: None, Quality.EVERY)
    connected.append(False)
    assert client.servers() == 0
    connected.append(True)  # discovered later than the recorder
    assert client.servers() == 1
    bus.node("other_recorder").subscribe("move_base/goal", Goal, lambda _: None, Quality.EVERY)
    assert client.servers() == 2
