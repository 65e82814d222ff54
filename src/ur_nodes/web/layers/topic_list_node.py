"""The topics that somebody publishes, as parts of the page look for them."""

from __future__ import annotations

import rospy


def list_topics() -> list[tuple[str, str]]:
    """Return full name and type of each topic; none while the master does not answer."""
    try:
        return [(str(name), str(kind)) for name, kind in rospy.get_published_topics()]
    except Exception:  # a master that does not answer has no topics now
        return []
