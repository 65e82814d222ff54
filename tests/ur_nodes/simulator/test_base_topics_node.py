from __future__ import annotations

import time
import xmlrpc.client
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from tests.base_contract import EVERY, list_topics, load
from tests.ur_nodes.simulator.test_simulator_node import Ros

pytestmark = pytest.mark.ros


@pytest.fixture
def ros(tmp_path: Path) -> Iterator[Ros]:
    started = Ros(tmp_path)
    yield started
    started.close()


def published(ros: Ros) -> set[str]:
    """The topics that somebody publishes, as the master knows them."""
    master = xmlrpc.client.ServerProxy(ros.env["ROS_MASTER_URI"])
    answer: Any = master.getSystemState("/test")
    return {topic for topic, nodes in answer[2][0] if "/simulator" in nodes}


def types(ros: Ros) -> dict[str, str]:
    answer: Any = xmlrpc.client.ServerProxy(ros.env["ROS_MASTER_URI"]).getTopicTypes("/test")
    return dict(answer[2])


@pytest.mark.parametrize(("name", "variant"), EVERY)
def test_simulated_base_publishes_what_its_file_says(ros: Ros, name: str, variant: str) -> None:
    expected = list_topics(load(name, variant))
    node = ros.simulate(f"_base:={name}", f"_variant:={variant}")
    end = time.monotonic() + 60.0
    while not set(expected) <= published(ros):
        assert node.poll() is None, "the simulator has ended"
        assert time.monotonic() < end, f"not published: {set(expected) - published(ros)}"
        time.sleep(0.1)
    known = types(ros)
    assert {topic: known[topic] for topic in expected} == expected
    kinds = {"sensor_msgs/Range", "sensor_msgs/LaserScan", "sensor_msgs/Imu", "sensor_msgs/BatteryState"}
    assert {topic for topic in published(ros) if known[topic] in kinds} <= set(expected)
