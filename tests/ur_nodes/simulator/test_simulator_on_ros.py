"""The node `simulator` with a master: topics and types, services, the camera's process, and the end."""

import subprocess
import sys
import xmlrpc.client
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import psutil
import pytest
from tests.base_contract import list_topics, load
from tests.ros_session import RosSession
from tests.ur_nodes.simulator.renderer import needs_renderer

HERE = Path(__file__).parent
SIMULATOR = HERE.parents[2] / "ubiquity_launches" / "n_simulator" / "bin" / "simulator"

pytestmark = pytest.mark.ros


class Ros(RosSession):
    """A client, and simulators."""

    def __init__(self, folder: Path) -> None:
        super().__init__(folder, (sys.executable, str(HERE / "client_node.py")))

    def simulate(self, *parameters: str) -> subprocess.Popen[str]:
        return self.start(str(SIMULATOR), "__name:=simulator", *parameters)

    def go_by_its_clock(self) -> None:
        xmlrpc.client.ServerProxy(self.env["ROS_MASTER_URI"]).setParam("/test", "/use_sim_time", True)

    def subscribers(self, topic: str) -> list[str]:
        """The nodes that subscribe to a topic."""
        answer: Any = xmlrpc.client.ServerProxy(self.env["ROS_MASTER_URI"]).getSystemState("/test")
        return next((nodes for name, nodes in answer[2][1] if name == topic), [])

    def types(self) -> dict[str, str]:
        answer: Any = xmlrpc.client.ServerProxy(self.env["ROS_MASTER_URI"]).getTopicTypes("/test")
        return dict(answer[2])


@pytest.fixture
def ros(tmp_path: Path) -> Iterator[Ros]:
    started = Ros(tmp_path)
    yield started
    started.close()


def test_topics_types_and_services_are_those_of_ros(ros: Ros) -> None:
    ros.go_by_its_clock()
    node = ros.simulate("_base:=magni", "_variant:=lidar", "_speed:=4.0")
    ros.ask("collect", topics=["/odom", "/tf", "/clock", "/scan", "/sonars"], count=5, seconds=60)
    expected = list_topics(load("magni", "lidar"))
    known = ros.types()
    assert {topic: known.get(topic) for topic in expected} == expected
    assert (known["/tf"], known["/clock"]) == ("tf2_msgs/TFMessage", "rosgraph_msgs/Clock")
    assert "/simulator" not in ros.subscribers("/clock")  # it has the time without a message to itself
    assert known["/simulator/collisions"] == "std_msgs/Int32"
    assert ros.ask("call", service="step") == [False, "not paused, expected ~pause with true before ~step"]
    assert ros.ask("call", service="pause", data=True) == [True, "paused"]
    assert ros.ask("call", service="step")[0] is True
    assert ros.ask("call", service="reset") == [None, None]
    assert ros.ask("call", service="place", x=2.0, y=0.0) is True
    refused = ros.try_to("call", service="place", x=-0.6, y=0.0)["error"]
    assert "robot_0 cannot be at x -0.6, y 0: a wall, expected free floor" in refused
    assert "Traceback" not in ros.stop(node)


def test_camera_process_is_there_while_somebody_looks_and_ends_with_the_node(ros: Ros) -> None:
    needs_renderer()
    process = ros.simulate("_base:=magni", "_camera_width:=160", "_camera_height:=120", "_camera_rate:=5.0")
    ros.ask("collect", topics=["/odom"], count=1, seconds=60)
    assert not psutil.Process(process.pid).children()  # nobody looks: nothing draws
    topics = [f"/raspicam_node/{name}" for name in ("image_raw", "image/compressed", "camera_info")]
    ros.ask("collect", topics=topics, count=2, seconds=60)
    drawing = psutil.Process(process.pid).children()
    assert len(drawing) == 1
    process.kill()
    assert not psutil.wait_procs(drawing, timeout=60)[1], "it draws on without a simulator"


def test_node_ends_when_told_to_even_at_full_speed(ros: Ros) -> None:
    node = ros.simulate("_speed:=0")
    ros.ask("collect", topics=["/odom"], count=1, seconds=60)
    node.terminate()
    _, errors = node.communicate(timeout=60)
    assert "Traceback" not in errors
