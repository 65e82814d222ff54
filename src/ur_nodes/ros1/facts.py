"""Facts, parameters and log of a node of ROS 1: the parameter server, and rospy's log."""

from __future__ import annotations

from typing import Any

import rospy

_FACTS = {"run_id": "/run_id"}  # the others are below /ur


class RosFacts:
    """See `ports.facts.Facts`."""

    def __init__(self) -> None:
        self.simulated_time = rospy.get_param("/use_sim_time", False) is True

    def get(self, name: str, default: Any = None) -> Any:
        """See Facts."""
        return rospy.get_param(_FACTS.get(name, f"/ur/{name}"), default)

    def set(self, name: str, value: Any) -> None:
        """See Facts."""
        rospy.set_param(_FACTS.get(name, f"/ur/{name}"), value)


class RosParameters:
    """See `ports.parameters.ParameterStore`."""

    def resolve(self, name: str) -> str:
        """See ParameterStore."""
        return str(rospy.resolve_name(name))

    def has(self, name: str) -> bool:
        """See ParameterStore."""
        return bool(rospy.has_param(name))

    def get(self, name: str) -> Any:
        """See ParameterStore."""
        return rospy.get_param(name)

    def set(self, name: str, value: Any) -> None:
        """See ParameterStore."""
        rospy.set_param(name, value)

    def names(self) -> list[str]:
        """See ParameterStore."""
        return sorted(map(str, rospy.get_param_names()))


class RosLog:
    """See `ports.log.Log`."""

    def __init__(self) -> None:
        self._last: dict[str, float] = {}

    def debug(self, text: str) -> None:
        """See Log."""
        rospy.logdebug("%s", text)

    def info(self, text: str) -> None:
        """See Log."""
        rospy.loginfo("%s", text)

    def warn(self, text: str, *, every: float = 0.0) -> None:
        """See Log."""
        if self._is_due(text, every):
            rospy.logwarn("%s", text)

    def error(self, text: str, *, every: float = 0.0) -> None:
        """See Log."""
        if self._is_due(text, every):
            rospy.logerr("%s", text)

    def _is_due(self, text: str, every: float) -> bool:
        if not every:
            return True
        now = rospy.get_time()
        if 0.0 <= now - self._last.get(text, -every) < every:
            return False
        if len(self._last) > 100:
            self._last.clear()
        self._last[text] = now
        return True
