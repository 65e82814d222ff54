"""Topics, services and actions of well-known nodes, by the name of their executable.

Those of upstream's nodes are from their documentation on wiki.ros.org; those of our nodes, which replace them under
the same names, are in src/ur_nodes/README.md. Names are as the node writes them: relative ones follow its namespace,
`~name` belongs to it, and remaps apply.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Interface:
    """The topics, services and actions of a node."""

    publishes: tuple[str, ...] = ()
    subscribes: tuple[str, ...] = ()
    services: tuple[str, ...] = ()  # that it offers
    calls: tuple[str, ...] = ()  # services of others
    actions: tuple[str, ...] = ()  # that it offers
    uses_actions: tuple[str, ...] = ()  # of others


def _node(
    publishes: str = "", subscribes: str = "", services: str = "", calls: str = "", actions: str = "", uses: str = ""
) -> Interface:
    parts = (publishes, subscribes, services, calls, actions, uses)
    return Interface(*(tuple(part.split()) for part in parts))


KNOWN_NODES: dict[str, Interface] = {
    "amcl": _node(
        "amcl_pose particlecloud tf",
        "scan tf initialpose map",
        "global_localization request_nomotion_update set_map",
        "static_map",
    ),
    "aruco_detect": _node(
        "fiducial_vertices fiducial_transforms fiducial_images tf", "camera/compressed camera_info ignore_fiducials"
    ),
    "explore": _node(
        "~frontiers ~status",
        "map tf move_base/global_costmap/costmap move_base/global_costmap/costmap_updates",
        uses="move_base",
    ),
    "explore_progress": _node("", "status"),
    "fiducial_slam": _node(
        "fiducials fiducial_map fiducial_pose tf",
        "fiducial_vertices camera_info tf initialpose",
        "clear_map save_map",
    ),
    "gmapping": _node("map map_metadata ~entropy tf", "scan tf", "dynamic_map"),
    "slam_gmapping": _node("map map_metadata ~entropy tf", "scan tf", "dynamic_map ~save"),
    "image_view": _node("", "image"),
    "joint_state_publisher": _node("joint_states"),
    "joy": _node("joy", "joy/set_feedback"),
    "joy_node": _node("joy", "joy/set_feedback"),
    "keyboard_navigate_node": _node(
        "initialpose move_base/continue patrol/request",
        "map scan tf amcl_pose move_base/hold patrol/status",
        uses="move_base",
    ),
    "map_saver": _node("", "map"),
    "map_server": _node("map map_metadata", "", "static_map"),
    "motor_node": _node("odom tf battery_state", "cmd_vel"),
    "move_base": _node(
        "cmd_vel cmd_vel_stamped ~current_goal ~global_costmap/costmap ~global_costmap/costmap_updates ~hold "
        "~local_costmap/costmap",
        "move_base_simple/goal map odom scan tf ~continue",
        "~make_plan ~clear_costmaps",
        "",
        "move_base",
    ),
    "patrol": _node("~status", "~request tf map", uses="move_base"),
    "raspicam_node": _node("~image ~image/compressed ~camera_info", "", "~start_capture ~stop_capture"),
    "robot_localization": _node("odometry/filtered tf", "odom imu"),
    "calibrate_camera": _node("", "", calls="raspicam_node/set_camera_info"),
    "ekf_localization_node": _node("odometry/filtered tf", "set_pose tf"),
    "robot_pose_ekf": _node("~odom_combined tf", "odom imu_data vo"),
    "robot_state_publisher": _node("tf tf_static", "joint_states"),
    "rplidarNode": _node("scan", "", "start_motor stop_motor"),
    "rviz": _node("initialpose move_base_simple/goal clicked_point", "tf tf_static"),
    "static_transform_publisher": _node("tf"),
    "stageros": _node("odom base_scan base_pose_ground_truth tf clock", "cmd_vel", "reset_positions"),
    "teleop_node": _node("cmd_vel", "joy"),
    "teleop_twist_joy": _node("cmd_vel", "joy"),
    "teleop_twist_keyboard": _node("cmd_vel"),
    "teleop_twist_keyboard.py": _node("cmd_vel"),
    "twist_mux": _node("cmd_vel_out", ""),
    "urg_node": _node("scan"),
    "usb_cam_node": _node("~image_raw ~camera_info", "", "~start_capture ~stop_capture"),
    "velocity_smoother": _node("smooth_cmd_vel", "raw_cmd_vel odometry robot_cmd_vel"),
}


# Where a package's own node says more than the upstream node whose name it bears.
KNOWN_IN_PACKAGE: dict[tuple[str, str], Interface] = {
    ("ubiquity_launches", "raspicam_node"): _node(
        "~image ~image/compressed ~camera_info", "", "~set_camera_info ~start_capture ~stop_capture"
    ),
    ("ubiquity_launches", "twist_mux"): _node(
        "cmd_vel_out ~active ~stopped ~challenge ~lease ~obstacle_stop",
        "joy_vel joy_vel_stamped key_vel key_vel_stamped web_vel web_vel_stamped nav_vel nav_vel_stamped pause_driving "
        "~lease_request odom scan sonars",
        "~stop ~release ~set_obstacle_stop",
    ),
    ("ubiquity_launches", "teleop_node"): _node(
        "cmd_vel_stamped cmd_vel_mux/lease_request",
        "joy cmd_vel_mux/challenge cmd_vel_mux/lease",
        calls="cmd_vel_mux/stop cmd_vel_mux/release",
    ),
    ("ubiquity_launches", "teleop_twist_keyboard.py"): _node(
        "cmd_vel_stamped cmd_vel_mux/lease_request",
        "cmd_vel_mux/active cmd_vel_mux/challenge cmd_vel_mux/lease cmd_vel_mux/obstacle_stop cmd_vel_mux/stopped",
        calls="cmd_vel_mux/stop cmd_vel_mux/release cmd_vel_mux/set_obstacle_stop",
    ),
    ("ubiquity_launches", "simulator"): _node(
        "odom joint_states base_pose_ground_truth tf ~collisions", "cmd_vel", "~pause ~step ~reset ~place"
    ),
    ("ubiquity_launches", "keyboard_navigate_node"): _node("initialpose", "map scan tf", uses="move_base"),
}


def find_interface(executable: str, package: str = "") -> Interface | None:
    """Look up the interface of an executable, of a package if that is given; None for an unknown one."""
    return KNOWN_IN_PACKAGE.get((package, executable)) or KNOWN_NODES.get(executable)
