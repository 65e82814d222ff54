"""Parameters of a node of ROS 2 that other programs set while it runs."""

from __future__ import annotations

import json
from pathlib import Path

from tests.ros2_session import Ros2Session

from ur.run.middleware.facts import add_parameters
from ur.system.ros import parameters_file

PROGRAM = """
import json
import rclpy
from rclpy.parameter import Parameter
from rclpy.parameter_service import SetParameters
from ur_nodes.ros2.node import RosNode

rclpy.init(args=["--ros-args", "-p", "rate:=20.0"])
node = RosNode("mux")
node.parameters.keep("stopped", True)
node.parameters.keep("limit", 50)
node.parameters.keep("limit", 62.5)
node.parameters.follow(lambda own: own.number("rate", live="rate, Hz"), lambda _changed: None)
other = rclpy.create_node("other")
client = other.create_client(SetParameters, "/mux/set_parameters")
node.begin()
assert client.wait_for_service(20.0)


def set(*given):
    request = SetParameters.Request(parameters=[Parameter(*each).to_parameter_msg() for each in given])
    answer = client.call_async(request)
    rclpy.spin_until_future_complete(other, answer, timeout_sec=20.0)
    return [each.successful for each in answer.result().results]


string = Parameter.Type.STRING
print(json.dumps({
    "unknown": set(*((f"p{number}", string, "x" * 10_000) for number in range(100))),
    "long": set(("stopped", string, "x" * 20_000)),
    "known": set(("rate", Parameter.Type.DOUBLE, 30.0)),
    "kept": [node.parameters.any(name) for name in ("stopped", "limit")],
    "names": [f"p{n}" for n in range(100) if node.parameters.has(f"p{n}")],
}))
node.close()
rclpy.shutdown()
"""


def test_other_programs_set_known_parameters_to_short_values_only(session: Ros2Session) -> None:
    done = session.run("-c", PROGRAM, within=90.0)
    assert done.stdout, done.stderr
    found = json.loads(done.stdout.splitlines()[-1])
    assert found == {
        "unknown": [False] * 100,
        "long": [False],
        "known": [True],
        "kept": [True, 62.5],
        "names": [],
    }


def test_node_reads_what_launch_files_give_another_node_that_does_not_run(session: Ros2Session, tmp_path: Path) -> None:
    facts = str(tmp_path / "facts.json")
    add_parameters(
        parameters_file(facts), {"/keyboard_navigate/map_name": "maze", "/keyboard_navigate/odd": b"no JSON"}
    )
    program = f"""
import os
os.environ["UR_FACTS"] = {facts!r}
import rclpy
from ur_nodes.ros2.node import RosNode

rclpy.init()
node = RosNode("page")
other = node.parameters.of("keyboard_navigate")
print(other.any("map_name", ""), other.any("odd", "none"), node.parameters.any("map_name", "none"))
node.close()
rclpy.shutdown()
"""
    done = session.run("-c", program, within=90.0)
    assert done.stdout.splitlines()[-1:] == ["maze none none"], done.stderr
