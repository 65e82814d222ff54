"""Nodes of two computers, as network namespaces, whose network is cut for real. Figures: `bench/link`."""

from __future__ import annotations

import select
import time
from collections.abc import Iterator
from functools import partial

import pytest
from rospy.impl import tcpros_pubsub
from tests.cut_network import can_make_networks
from tests.json_client import wait_until
from tests.link_trial import TOPICS, LinkTrial, link_trial

from ur_nodes.ros1.repairs import connections

GENEROUS = 15.0  # s; with rospy as it is, a cut of 5 s takes longer, and latched topics do not come again at all

pytestmark = pytest.mark.skipif(not can_make_networks(), reason="making network namespaces needs root")


@pytest.fixture(scope="module")
def trial() -> Iterator[LinkTrial]:
    with link_trial() as made:
        assert set(made.wait_for_all(time.monotonic(), 60.0)) == set(TOPICS)
        yield made


def pass_time(seconds: float) -> None:
    time.sleep(seconds)  # the cut itself


def test_topics_of_both_directions_come_again_after_a_cut(trial: LinkTrial) -> None:
    threads = {topic: trial.threads(topic) for topic in ("tf", "key_vel")}  # one topic for each direction
    trial.network.cut()
    pass_time(4.5)
    trial.network.restore()
    back = time.monotonic()
    assert set(trial.wait_for_all(back, GENEROUS)) == set(TOPICS)
    assert trial.oldest(back) < 2.0  # nothing of the cut comes after it
    assert trial.count("map", back) == trial.count("goal", back) == 1  # one connection each
    for topic, before in threads.items():
        wait_until(partial(trial.keeps_to, topic, before + 1), GENEROUS, f"threads to end where {topic} is received")


def test_subscriber_that_only_receives_is_told_that_its_connection_has_ended(trial: LinkTrial) -> None:
    subscriber = trial.start_subscriber("status")
    assert subscriber.stdout
    assert subscriber.stdout.readline() == "receives\n"
    trial.network.cut()
    pass_time(4.5)
    trial.network.restore()
    assert select.select([subscriber.stdout], [], [], GENEROUS)[0]  # its own kernel would ask after two hours
    assert subscriber.stdout.readline() == "ended\n"


def test_what_a_killed_program_sent_during_a_cut_never_arrives(trial: LinkTrial) -> None:
    trial.network.cut()
    pass_time(0.8)
    trial.laptop.kill()
    pass_time(3.0)
    trial.network.restore()
    back = time.monotonic()
    pass_time(4.0)
    assert trial.count("key_vel", back) == 0


def test_rospy_that_is_too_different_is_left_alone(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.delattr(tcpros_pubsub, "robust_connect_subscriber")
    assert not connections.bound_connections()
    assert "robust_connect_subscriber" in caplog.text
