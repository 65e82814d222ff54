"""Log files that cannot be written, for nodes that are still written against rospy."""

from __future__ import annotations

from ur_nodes.ros1.repairs.log_errors import report_log_errors as report_log_errors
from ur_nodes.ros1.repairs.log_errors import say_nothing as say_nothing
