"""Rules for what a page may publish, call and set: nothing that moves a base without the limits of the mux."""

from collections.abc import Collection, Mapping

_DRIVE = "expected the stick of the page, whose commands prove their age to the mux"
_GOALS = "expected 'Goal' of the page: such a goal is held when the page is out of reach"
_FALSE = "a false one would let navigation drive the robot into what it does not see"

_KINDS: Mapping[str, str] = {
    **dict.fromkeys(
        (
            "geometry_msgs/Twist",
            "geometry_msgs/TwistStamped",
            "geometry_msgs/TwistWithCovariance",
            "geometry_msgs/TwistWithCovarianceStamped",
            "ackermann_msgs/AckermannDrive",
            "ackermann_msgs/AckermannDriveStamped",
            "geometry_msgs/Wrench",
            "geometry_msgs/WrenchStamped",
            "trajectory_msgs/JointTrajectory",
            "trajectory_msgs/MultiDOFJointTrajectory",
            "sensor_msgs/Joy",
        ),
        f"it may set a base in motion past the mux, {_DRIVE}",
    ),
    "tf2_msgs/TFMessage": f"it places frames and the robot; {_FALSE}",
    "tf/tfMessage": f"it places frames and the robot; {_FALSE}",
    "rosgraph_msgs/Clock": "it is the time of all nodes, which only a simulator sets",
    **dict.fromkeys(
        (
            "nav_msgs/Odometry",
            "nav_msgs/OccupancyGrid",
            "map_msgs/OccupancyGridUpdate",
            "sensor_msgs/LaserScan",
            "sensor_msgs/MultiEchoLaserScan",
            "sensor_msgs/PointCloud",
            "sensor_msgs/PointCloud2",
            "sensor_msgs/Range",
            "sensor_msgs/Imu",
            "sensor_msgs/JointState",
        ),
        f"it is measured by the robot; {_FALSE}",
    ),
}
"""Reasons by type."""

_OWNERS: Mapping[str, str] = {
    "cmd_vel_mux": f"the mux reads it, {_DRIVE}",
    "move_base": f"navigation reads it, {_GOALS}",
    "explore": "the exploration reads it, expected its program",
    "amcl": "localisation reads it, expected 'Pose' of the page",
    "slam_gmapping": "localisation reads it, expected 'Pose' of the page",
    "fiducial_slam": "localisation reads it, expected 'Pose' of the page",
}
"""Reasons by the last part of the name of a node that subscribes, and by any part of the name of a topic."""

_TOPICS: Mapping[str, str] = {
    "initialpose": "it moves the robot on its map, expected 'Pose' of the page",
    "move_base_simple": f"it is a goal, {_GOALS}",
    "pause_driving": "it stops the robot, expected the stop of the page",
    "bumper": f"it is measured by the robot; {_FALSE}",
    "cliff": f"it is measured by the robot; {_FALSE}",
    "rosout": "it is the log of all nodes",
    "rosout_agg": "it is the log of all nodes",
}
"""Reasons by any part of the name of a topic."""

_MOTION = ("cmd_vel", "vel", "motor", "motors", "wheel", "wheels", "drive", "brake", "effort", "throttle", "steering")
"""Parts of the last word of a topic that names what moves."""

_SERVICES: Mapping[str, str] = {
    "release": "it ends an emergency stop, expected 'Release' of the page",
}
_PARAMETERS = ("/ur", "/run_id", "/roslaunch", "/rosdistro", "/rosversion", "/use_sim_time")


def refuse_topic(topic: str, kind: str, subscribers: Collection[str] = ()) -> str | None:
    """Return the reason why a page may not publish on a topic; None if it may. `subscribers` are names of nodes."""
    kind = kind.replace("/msg/", "/")  # as ROS 2 names it
    if kind in _KINDS:
        return f"{topic}: {kind} is not published from here: {_KINDS[kind]}"
    if kind.endswith(("ActionGoal", "ActionResult", "ActionFeedback")) or kind.startswith("actionlib_msgs/"):
        return f"{topic}: an action is not published from here: {_GOALS}"
    parts = topic.strip("/").split("/")
    for part in parts:
        if part in _TOPICS or part in _OWNERS:
            return f"{topic} is not published from here: {_TOPICS.get(part) or _OWNERS[part]}"
    words = parts[-1].lower().split("_")
    if any(word in _MOTION for word in words) or "cmd_vel" in parts[-1]:
        return f"{topic} is not published from here: its name is that of what moves a base, {_DRIVE}"
    for node in sorted(subscribers):
        owner = node.rpartition("/")[2]
        if owner in _OWNERS:
            return f"{topic} is not published from here: {_OWNERS[owner]}"
    return None


def refuse_service(service: str) -> str | None:
    """Return the reason why a page may not call a service; None if it may."""
    parts = service.strip("/").split("/")
    if "cmd_vel_mux" in parts and parts[-1] in _SERVICES:
        return f"{service} is not called from here: {_SERVICES[parts[-1]]}"
    return None


def refuse_parameter(name: str) -> str | None:
    """Return the reason why a page may not set a parameter; None if it may."""
    if any(name == each or name.startswith(f"{each}/") for each in _PARAMETERS):
        return f"{name} is not set from here: it belongs to the run"
    if "cmd_vel_mux" in name.strip("/").split("/"):
        return f"{name} is not set from here: it is a limit of the mux, expected 'Speed' of the page"
    return None
