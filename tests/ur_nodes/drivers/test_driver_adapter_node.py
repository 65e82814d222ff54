from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.base_contract import PACKAGE
from tests.ros_session import RosSession

pytestmark = pytest.mark.ros
ADAPTER = PACKAGE / "n_driver_adapter" / "bin" / "driver_adapter"
# The package of upstream's message, as little of it as is needed.
MESSAGES = """
from ur_nodes.codecs.genpy.fiducials import make_classes

Sensor = make_classes("neato_node", {"Sensor": "bool value\\nstring name"})["Sensor"]
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


def test_adapter_refuses_messages_that_it_cannot_use_in_one_clear_message(ros: RosSession) -> None:
    for kind, message in (
        ("nowhere/Sensor", "expected a type of message as package/Name"),
        ("std_msgs/Bool", "messages std_msgs/Bool have no name and value"),
    ):
        node = ros.start(str(ADAPTER), "_base:=botvac", f"_bumper_messages:={kind}")
        _, errors = node.communicate(timeout=60)
        assert node.returncode == 2
        assert message in errors
        assert "Traceback" not in errors
