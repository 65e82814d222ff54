"""Facts, parameters and log of a node of ROS 1: the parameter server, and rospy's log."""

from __future__ import annotations

from functools import partial

import rospy

from ur_nodes.ports.log import ThrottledLog

_FACTS = {"run_id": "/run_id"}  # the others are below /ur


class RosFacts:
    """See `ports.facts.Facts`."""

    def __init__(self) -> None:
        self.simulated_time = rospy.get_param("/use_sim_time", False) is True

    def get(self, name: str, default: object = None) -> object:
        return rospy.get_param(_FACTS.get(name, f"/ur/{name}"), default)

    def set(self, name: str, value: object) -> None:
        rospy.set_param(_FACTS.get(name, f"/ur/{name}"), value)


class RosParameters:
    """See `ports.parameters.ParameterStore`."""

    def resolve(self, name: str) -> str:
        return str(rospy.resolve_name(name))

    def has(self, name: str) -> bool:
        return bool(rospy.has_param(name))

    def get(self, name: str) -> object:
        return rospy.get_param(name)

    def set(self, name: str, value: object) -> None:
        rospy.set_param(name, value)

    def names(self) -> list[str]:
        return sorted(map(str, rospy.get_param_names()))


def make_log() -> ThrottledLog:
    """The log of a node."""
    debug, info, warn, error = (
        partial(write, "%s") for write in (rospy.logdebug, rospy.loginfo, rospy.logwarn, rospy.logerr)
    )
    return ThrottledLog(debug, info, warn, error, rospy.get_time)
