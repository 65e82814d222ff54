"""The clients' end of challenges on a bus."""

import pytest

from ur_nodes.memory.bus import Bus
from ur_nodes.motion.challenge.freshness import FRESHNESS
from ur_nodes.motion.challenge.link import AdaptivePublisher, ChallengeLink, FreshPublisher, stamped_name
from ur_nodes.ports.values import StampedTwist, Time, Twist

AHEAD = Twist(0.3, 0.0)


def test_commands_carry_the_newest_challenge_until_it_is_old() -> None:
    bus = Bus()
    mux, node = bus.node("mux"), bus.node("client")
    challenges, got = mux.publish("mux/challenge", Time), list[StampedTwist]()
    mux.subscribe("cmd_vel_stamped", StampedTwist, got.append)
    link = ChallengeLink(node, "mux")
    fresh = FreshPublisher("cmd_vel", link, "me")
    assert not link.received
    assert not fresh.send(AHEAD)
    challenges.send(Time(5))
    challenges.send(Time(7))
    bus.run(FRESHNESS - 0.01)
    assert fresh.send(AHEAD)
    bus.run(0.02)
    assert not fresh.send(AHEAD)
    assert got == [StampedTwist(7, "me", AHEAD)]
    assert link.link_age() == pytest.approx(FRESHNESS + 0.01)


def test_adaptive_commands_are_plain_only_where_no_challenge_ever_was() -> None:
    bus = Bus()
    mux, node = bus.node("mux"), bus.node("client")
    plain: list[Twist] = []
    mux.subscribe("cmd_vel", Twist, plain.append)
    publisher = AdaptivePublisher("cmd_vel", ChallengeLink(node, "mux"), "me")
    publisher.send(AHEAD)
    assert (publisher.plain, publisher.topic, publisher.subscribers()) == (True, "/cmd_vel", 1)
    mux.publish("mux/challenge", Time).send(Time(1))
    bus.run(10.0)
    publisher.send(AHEAD)
    bus.run(0.1)
    assert not publisher.plain
    assert plain == [AHEAD]


@pytest.mark.parametrize(
    ("remaps", "name"),
    [
        ({}, "/cmd_vel_stamped"),
        ({"cmd_vel": "nav_vel"}, "/nav_vel_stamped"),
        ({"cmd_vel": "nav_vel", "cmd_vel_stamped": "other"}, "/other"),
    ],
)
def test_name_of_stamped_commands_follows_that_of_plain_ones(remaps: dict[str, str], name: str) -> None:
    assert stamped_name(Bus().node("client", remaps), "cmd_vel") == name
