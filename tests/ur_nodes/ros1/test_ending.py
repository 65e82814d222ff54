from __future__ import annotations

import pytest
import rospy

from ur_nodes.ros1.ending import quiet_at_end


def publish(number: int, *, closed: bool) -> None:
    if closed:
        raise rospy.ROSException(f"publish() {number} to a closed topic")


def test_closed_topic_is_no_error_while_the_node_ends() -> None:
    with pytest.raises(rospy.ROSException, match="closed topic"):
        quiet_at_end(publish)(3, closed=True)
    quiet_at_end(publish, lambda: True)(3, closed=True)


def test_other_errors_of_a_callback_are_never_hidden() -> None:
    def divide(by: int) -> None:
        raise ZeroDivisionError(by)

    with pytest.raises(ZeroDivisionError):
        quiet_at_end(divide, lambda: True)(0)
