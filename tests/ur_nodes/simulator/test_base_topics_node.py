from __future__ import annotations

import time
import xmlrpc.client
from collections.abc import Iterator
from typing import Any

import pytest
from tests.base_contract import EVERY, list_topics, load
from tests.ros_session import RosSession
from tests.ur_nodes.simulator.test_simulator_node import SIMULATOR

pytestmark = pytest.mark.ros


@pytest.fixture(scope="module")
def ros(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RosSession]:
    started = RosSession(tmp_path_factory.mktemp("ros"))
    yield started
    started.close()


def published(ros: RosSession, node: str) -> set[str]:
    """The topics that a node publishes, as the master knows them."""
    master = xmlrpc.client.ServerProxy(ros.env["ROS_MASTER_URI"])
    answer: Any = master.getSystemState("/test")
    return {topic for topic, nodes in answer[2][0] if f"/{node}" in nodes}


def types(ros: RosSession) -> dict[str, str]:
    answer: Any = xmlrpc.client.ServerProxy(ros.env["ROS_MASTER_URI"]).getTopicTypes("/test")
    return dict(answer[2])


@pytest.mark.parametrize(("name", "variant"), EVERY)
def test_simulated_base_publishes_what_its_file_says(ros: RosSession, name: str, variant: str) -> None:
    expected = list_topics(load(name, variant))
    own = f"simulator_{name}_{variant}"  # parameters outlive a node
    node = ros.start(str(SIMULATOR), f"__name:={own}", f"_base:={name}", f"_variant:={variant}")
    end = time.monotonic() + 60.0
    while not set(expected) <= published(ros, own):
        assert node.poll() is None, "the simulator has ended"
        assert time.monotonic() < end, f"not published: {set(expected) - published(ros, own)}"
        time.sleep(0.1)
    known = types(ros)
    assert {topic: known[topic] for topic in expected} == expected
    kinds = {"sensor_msgs/Range", "sensor_msgs/LaserScan", "sensor_msgs/Imu", "sensor_msgs/BatteryState"}
    assert {topic for topic in published(ros, own) if known[topic] in kinds} <= set(expected)
    assert "Traceback" not in ros.stop(node)
