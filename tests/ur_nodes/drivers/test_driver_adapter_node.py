from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.base_contract import PACKAGE, load
from tests.ros_session import RosSession

pytestmark = pytest.mark.ros
ADAPTER = PACKAGE / "n_driver_adapter" / "bin" / "driver_adapter"
# The package of upstream's message, as little of it as is needed.
MESSAGES = """
from genpy.dynamic import generate_dynamic

Sensor = generate_dynamic("neato_node/Sensor", "bool value\\nstring name\\n")["neato_node/Sensor"]
"""


@pytest.fixture
def ros(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[RosSession]:
    """With a stand-in for a driver."""
    messages = tmp_path / "python" / "neato_node" / "msg"
    messages.mkdir(parents=True)
    (messages / "__init__.py").write_text(MESSAGES)
    (messages.parent / "__init__.py").write_text("")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path / "python"), prepend=os.pathsep)
    started = RosSession(tmp_path, (sys.executable, str(Path(__file__).with_name("driver_client_node.py"))))
    yield started
    started.close()


def test_wheels_turn_as_the_odometry_of_the_driver_says(ros: RosSession) -> None:
    ros.start(str(ADAPTER), "_base:=loki")
    ros.ask("listen", topics=["joint_states", "tf", "scan"])
    ros.ask("send", topic="odom", until="joint_states", count=8, speed=0.3)
    first, *_, last = ros.ask("wait", topic="joint_states", count=8)
    assert first["names"] == ["left_wheel_joint", "right_wheel_joint"]
    rolled = [(b - a) * load("loki", "").wheels.radius for a, b in zip(first["angles"], last["angles"], strict=True)]
    assert rolled == pytest.approx([0.3 * (last["stamp"] - first["stamp"])] * 2, rel=1e-6)
    assert last["speeds"] == pytest.approx([10.0, 10.0])
    assert ros.ask("wait", topic="tf", count=0) == []  # the driver publishes it itself


def test_frames_of_stage_become_those_of_the_base(ros: RosSession) -> None:
    ros.start(str(ADAPTER), "_base:=stage", "_publish_tf:=true", "_rename_scan:=true")
    ros.ask("listen", topics=["joint_states", "tf", "scan"])
    ros.ask("send", topic="odom", until="tf", count=2, speed=0.0)
    assert ros.ask("wait", topic="tf", count=1)[0] == ["odom", "base_footprint", 3.0]
    ros.ask("send", topic="driver/scan", until="scan", count=1)
    assert ros.ask("wait", topic="scan", count=1)[0] == ["laser", [1.0, 2.0]]


def test_bumpers_of_neato_become_latched_topics_of_the_base(ros: RosSession) -> None:
    names = "{Left_Side_Bumper: left_side, Left_Bumper: left_front}"
    ros.start(
        *(str(ADAPTER), "_base:=botvac", "_bumper_messages:=neato_node/Sensor", f"_bumper_names:={names}"),
        "driver/bumpers:=sensor",
    )
    ros.ask("listen", topics=["bumper/left_front", "bumper/right_front"])
    assert ros.ask("wait", topic="bumper/right_front", count=1) == [False]
    assert ros.ask("wait", topic="bumper/left_front", count=1) == [False]
    ros.ask("send", topic="sensor", until="bumper/left_front", count=2, name="Left_Bumper")
    assert ros.ask("wait", topic="bumper/left_front", count=3) == [False, True, False]
    assert ros.ask("wait", topic="bumper/right_front", count=1) == [False]


MISTAKES = [
    (["_base:=lokki"], "unknown base 'lokki'"),
    (["_base:=botvac", "_bumper_messages:=nowhere/Sensor"], "expected a type of message as package/Name"),
    (["_base:=botvac", "_bumper_messages:=std_msgs/Bool"], "messages std_msgs/Bool have no name and value"),
    (
        ["_base:=botvac", "_bumper_messages:=neato_node/Sensor", "_bumper_names:={Left_Bumper: roof}"],
        "expected a map from upstream's names to some of left_side",
    ),
]


def test_adapter_refuses_what_it_cannot_use_in_one_clear_message(ros: RosSession) -> None:
    for number, (parameters, message) in enumerate(MISTAKES):
        node = ros.start(str(ADAPTER), f"__name:=adapter_{number}", *parameters)
        _, errors = node.communicate(timeout=60)
        assert node.returncode == 2
        assert message in errors
        assert "Traceback" not in errors
