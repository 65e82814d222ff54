"""Parameters of a node from the parameter server."""

from __future__ import annotations

from typing import Any

import rospy

from ur_nodes.ports import parameters


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


class Parameters(parameters.Parameters):
    """Parameters below `namespace` ('~' is the node itself)."""

    def __init__(self, namespace: str = "~") -> None:
        super().__init__(RosParameters(), namespace)
