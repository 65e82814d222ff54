"""Logs of rospy: their configuration, and those that cannot be written, as on a full disk or an ended terminal.

One line in place of a traceback for each message, and no exception in the code that logs: a driver whose supervisor was
killed still has motors to stop.
"""

import logging
import os
import sys
from collections.abc import Callable
from contextlib import suppress


def skip_log_link() -> None:
    """Stop rospy from making the link `latest`, which the program that starts a run makes: nodes collide there."""
    from rosgraph import roslogging

    roslogging.renew_latest_logdir = lambda _folder: True


def choose_log_configuration() -> None:
    """Name the file that rospy finds in ROS_HOME or /etc/ros; it would read all packages before it looks there."""
    import rospkg

    folders = f"{rospkg.get_ros_home()}/config", rospkg.get_etc_ros_dir()
    files = [f"{folder}/python_logging.{kind}" for folder in folders for kind in ("conf", "yaml")]
    if found := next(filter(os.path.isfile, files), None):
        os.environ.setdefault("ROS_PYTHON_LOG_CONFIG_FILE", found)


def report_log_errors(report: Callable[[str], None] | None = None) -> None:
    """Report each log file of this process that cannot be written once, by default on standard error.

    To be called after `rospy.init_node`, which opens the log file. Later messages still reach /rosout and the terminal.
    """
    handlers = {handler for name in ("", "rosout") for handler in logging.getLogger(name).handlers}
    for handler in handlers:
        if isinstance(handler, logging.FileHandler):
            # On the instance instead of in a subclass, since rospy makes the handlers.
            setattr(handler, "handleError", _report_once(handler.baseFilename, report or _write))  # noqa: B010
        else:
            setattr(handler, "emit", _drop_unread(handler.emit))  # noqa: B010


def discard_line(_line: str) -> None:
    """Drop a line, for programs that draw on their terminal."""


def _report_once(path: str, report: Callable[[str], None]) -> Callable[[logging.LogRecord], None]:
    reported = False

    def report_error(_record: logging.LogRecord) -> None:
        nonlocal reported
        if not reported:
            reported = True
            problem = sys.exc_info()[1]
            report(f'warning: the log file "{path}" cannot be written: {problem}; later messages are not kept there')

    return report_error


def _drop_unread(emit: Callable[[logging.LogRecord], None]) -> Callable[[logging.LogRecord], None]:
    def emit_where_read(record: logging.LogRecord) -> None:
        with suppress(OSError, ValueError):  # rospy's handler of the terminal catches nothing
            emit(record)

    return emit_where_read


def _write(line: str) -> None:
    with suppress(OSError, ValueError):
        sys.stderr.write(line + "\n")
