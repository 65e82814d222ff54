"""The start of rospy: what it does in every node, and no node needs."""

import os
import sys
from types import ModuleType

_CATKIN = "catkin.find_in_workspaces"


def defer_catkin() -> None:
    """Import what finds packages in workspaces when it is used: 4 MB, which rospy imports and never calls."""
    module = ModuleType(_CATKIN)

    def find_in_workspaces(*arguments: object, **options: object) -> object:
        del sys.modules[_CATKIN]
        from catkin.find_in_workspaces import find_in_workspaces  # type: ignore[import-untyped]

        return find_in_workspaces(*arguments, **options)

    module.find_in_workspaces = find_in_workspaces  # type: ignore[attr-defined]
    sys.modules.setdefault(_CATKIN, module)


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
