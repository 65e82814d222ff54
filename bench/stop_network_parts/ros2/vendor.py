"""A plain commander of another vendor's middleware: vendor LANE NOTES. It knows DDS, and nothing of ROS 2."""

import os
import sys
import time
from dataclasses import dataclass
from pathlib import Path

from bench.stop_network_parts.lane import PATTERNS
from bench.stop_network_parts.ros2.person import PERIOD, Person
from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import float64
from cyclonedds.pub import DataWriter
from cyclonedds.topic import Topic
from cyclonedds.util import duration

_RELIABLE = Qos(
    Policy.Reliability.Reliable(max_blocking_time=duration(milliseconds=100)),
    Policy.Durability.Volatile,
    Policy.History.KeepLast(10),
)


@dataclass
class Vector3(IdlStruct, typename="geometry_msgs::msg::dds_::Vector3_"):
    """geometry_msgs/Vector3."""

    x: float64
    y: float64
    z: float64


@dataclass
class Twist(IdlStruct, typename="geometry_msgs::msg::dds_::Twist_"):
    """geometry_msgs/Twist."""

    linear: Vector3
    angular: Vector3


def main(lane: str, notes: str) -> None:
    """Run until it is killed."""
    participant = DomainParticipant(int(os.environ["ROS_DOMAIN_ID"]))
    writer = DataWriter(participant, Topic(participant, f"rt/{lane}/cmd_vel", Twist, qos=_RELIABLE), qos=_RELIABLE)
    person = Person(Path(notes), PATTERNS)
    while True:
        time.sleep(PERIOD)
        if person.drives:
            speed = person.speed()
            person.note(speed)
            writer.write(Twist(Vector3(speed, 0.0, 0.0), Vector3(0.0, 0.0, 0.0)))


if __name__ == "__main__":
    main(*sys.argv[1:3])
