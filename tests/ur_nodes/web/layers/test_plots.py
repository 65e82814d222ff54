from __future__ import annotations

import io
import json
from typing import Any

import pytest
from tests.ur_nodes.web.layers.test_layers_node import Topics

from ur.web.wire.frames import Kind, Layer, key_of

pytest.importorskip("rospy", reason="ROS is not installed")

import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from sensor_msgs.msg import BatteryState

from ur_nodes.web.layers.plots import PlotFeed, list_fields, read_number

SPEED, TURN = "/odom:twist.twist.linear.x", "/odom:twist.twist.angular.z"


def wire(message: Any) -> Any:
    """A message as rospy hands it over to those who want any type."""
    buffer = io.BytesIO()
    message.serialize(buffer)
    return rospy.AnyMsg().deserialize(buffer.getvalue())


class Plots:
    def __init__(self) -> None:
        self.topics, self.frames, self.now = Topics(), list[bytes](), 10.0
        found = [
            ("/odom", "nav_msgs/Odometry"),
            ("/strange", "not_installed/Type"),
            ("/cmd_vel", "geometry_msgs/Twist"),
        ]
        self.feed = PlotFeed(self.frames.append, lambda: found, self.topics.subscribe)

    def step(self) -> None:
        self.now += 5.0
        self.feed.step(self.now)

    def take(self, kind: Kind) -> list[Any]:
        """The frames of a kind so far."""
        assert all(key_of(frame)[1] == Layer.PLOTS for frame in self.frames)
        return [json.loads(frame[6:]) for frame in self.frames if key_of(frame)[0] == kind]


def test_numeric_fields_of_a_message_are_found_without_headers_and_arrays() -> None:
    assert list_fields("geometry_msgs/Twist") == [f"{part}.{axis}" for part in ("linear", "angular") for axis in "xyz"]
    battery = list_fields("sensor_msgs/BatteryState")
    assert {"voltage", "percentage", "present"} <= set(battery)
    assert not {"header.seq", "cell_voltage", "location"} & set(battery)
    assert list_fields("not_installed/Type") == []


@pytest.mark.parametrize(
    ("path", "number"),
    [("voltage", 12.5), ("present", 1.0), ("location", None), ("current", None), ("voltage.real", None), ("_x", None)],
)
def test_number_is_read_only_from_a_numeric_field(path: str, number: float | None) -> None:
    assert read_number(BatteryState(voltage=12.5, present=True, current=float("nan")), path) == number


def test_plots_are_sampled_while_they_are_wanted() -> None:
    plots = Plots()
    plots.feed.want([SPEED, TURN, "/strange:x", "no plot"], shown=False)
    plots.step()
    assert set(plots.topics.callbacks) == {"/odom"}
    message = Odometry()
    for speed in (0.1, 0.2):
        message.twist.twist.linear.x = speed
        plots.topics.publish("/odom", wire(message))
    plots.step()
    assert [each["v"] for each in plots.take(Kind.VALUES)] == [{SPEED: 0.2, TURN: 0.0}]
    plots.step()
    assert len(plots.take(Kind.VALUES)) == 1, "no sample without a message"
    plots.feed.want([], shown=False)
    plots.step()
    assert not plots.topics.callbacks


def test_message_of_another_type_than_the_master_says_has_no_numbers() -> None:
    plots = Plots()
    plots.feed.want([SPEED], shown=False)
    plots.step()
    plots.topics.publish("/odom", wire(Twist()))
    plots.step()
    assert plots.take(Kind.VALUES) == []


def test_fields_are_offered_while_a_page_chooses() -> None:
    plots = Plots()
    plots.feed.want([], shown=True)
    plots.step()
    plots.step()
    (offered,) = plots.take(Kind.FIELDS)
    assert set(offered["fields"]) == {"/cmd_vel", "/odom"}
    assert "twist.twist.linear.x" in offered["fields"]["/odom"]
