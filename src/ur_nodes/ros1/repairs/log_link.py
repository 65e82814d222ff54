"""The link `latest` to the newest folder of logs, which the program that starts a run makes."""

from __future__ import annotations

from rosgraph import roslogging


def leave_log_link() -> None:
    """Have rospy leave the link alone: nodes that all make it anew collide, and log that."""
    roslogging.renew_latest_logdir = lambda _folder: True
