"""A real node, looked at through a real master."""

from __future__ import annotations

import os
from pathlib import Path

import psutil
import pytest

from ur.source.diagnostic import UserError
from ur.tools.new.observe import observe_node
from ur.tools.new.parts import NodeTopic

pytestmark = pytest.mark.ros

NODE = """#!/usr/bin/python3
import rospy
from std_msgs.msg import String
from std_srvs.srv import Empty, EmptyResponse

rospy.init_node("talker")
rate = rospy.get_param("~rate", 5)
rospy.set_param("~names/first", "Ada")
rospy.Publisher("chatter", String, queue_size=1)
rospy.Publisher("~status", String, queue_size=1)
rospy.Subscriber("orders", String, print)
rospy.Service("~clear", Empty, lambda _: EmptyResponse())
rospy.spin()
"""


def make(folder: Path, text: str) -> list[str]:
    path = folder / "talker"
    path.write_text(text)
    path.chmod(0o755)
    return [str(path)]


def test_node_shows_its_topics_services_and_parameters_and_leaves_nothing(tmp_path: Path) -> None:
    told: list[str] = []
    before = {each.pid for each in psutil.Process().children(recursive=True)}
    seen = observe_node(make(tmp_path, NODE), os.environ, 60.0, told.append)
    assert seen.topics == (
        NodeTopic("orders", "std_msgs/String"),
        NodeTopic("chatter", "std_msgs/String", published=True),
        NodeTopic("~status", "std_msgs/String", published=True),
    )
    assert seen.services == ("~clear",)
    assert seen.parameters == {"rate": None, "names/first": "Ada"}
    assert {each.pid for each in psutil.Process().children(recursive=True)} == before


def test_program_that_is_no_node_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="ended with 3, expected a ROS node"):
        observe_node(make(tmp_path, "#!/bin/sh\nexit 3\n"), os.environ, 60.0, lambda _: None)
