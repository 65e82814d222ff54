"""Save the map while it is made."""

from __future__ import annotations

import rospy
from std_srvs.srv import Trigger

from ur.maps.names import is_map_name

_PATIENCE = 10.0  # s until a service that is not there counts as missing


def save_map(service: str) -> tuple[str, str]:
    """Call a service that saves the map; returns the name of the map, or '' and the reason."""
    try:
        rospy.wait_for_service(service, _PATIENCE)
        answer = rospy.ServiceProxy(service, Trigger)()
    except (rospy.ROSException, rospy.ServiceException) as problem:
        return "", str(problem)
    if not answer.success:
        return "", answer.message
    return (answer.message, "") if is_map_name(answer.message) else ("", "the service answers no name of a map")
