"""Topics, services and actions of well-known nodes, by the name of their executable.

Those of upstream's nodes are from their documentation on wiki.ros.org. This library's nodes, which replace some of them
under the same names, declare theirs in the heads of their executables (`library_nodes`). Names are as the node writes
them: relative ones follow its namespace, `~name` belongs to it, and remaps apply.
"""

from ur.launchfile.query.arguments import Interface, make_interface
from ur.launchfile.query.library_nodes import LIBRARY_NODES

KNOWN_NODES: dict[str, Interface] = {
    "amcl": make_interface(
        "amcl_pose particlecloud tf",
        "scan tf initialpose map",
        "global_localization request_nomotion_update set_map",
        "static_map",
    ),
    "aruco_detect": make_interface(
        "fiducial_vertices fiducial_transforms fiducial_images tf", "camera/compressed camera_info ignore_fiducials"
    ),
    "explore": make_interface(
        "~frontiers ~status",
        "map tf move_base/global_costmap/costmap move_base/global_costmap/costmap_updates",
        uses="move_base",
    ),
    "fiducial_slam": make_interface(
        "fiducials fiducial_map fiducial_pose tf", "fiducial_vertices camera_info tf initialpose", "clear_map save_map"
    ),
    "gmapping": make_interface("map map_metadata ~entropy tf", "scan tf", "dynamic_map"),
    "slam_gmapping": make_interface("map map_metadata ~entropy tf", "scan tf", "dynamic_map ~save"),
    "image_view": make_interface("", "image"),
    "joint_state_publisher": make_interface("joint_states"),
    "joy": make_interface("joy", "joy/set_feedback"),
    "joy_node": make_interface("joy", "joy/set_feedback"),
    "map_saver": make_interface("", "map"),
    "map_server": make_interface("map map_metadata", "", "static_map"),
    "motor_node": make_interface("odom tf battery_state", "cmd_vel"),
    "move_base": make_interface(
        "cmd_vel cmd_vel_stamped ~current_goal ~global_costmap/costmap ~global_costmap/costmap_updates ~hold "
        "~local_costmap/costmap",
        "move_base_simple/goal map odom scan tf",
        "~make_plan ~clear_costmaps",
        "",
        "move_base",
    ),
    "raspicam_node": make_interface("~image ~image/compressed ~camera_info", "", "~start_capture ~stop_capture"),
    "robot_localization": make_interface("odometry/filtered tf", "odom imu"),
    "ekf_localization_node": make_interface("odometry/filtered tf", "set_pose tf"),
    "robot_pose_ekf": make_interface("~odom_combined tf", "odom imu_data vo"),
    "robot_state_publisher": make_interface("tf tf_static", "joint_states"),
    "rplidarNode": make_interface("scan", "", "start_motor stop_motor"),
    "rviz": make_interface("initialpose move_base_simple/goal clicked_point", "tf tf_static"),
    "static_transform_publisher": make_interface("tf"),
    "stageros": make_interface("odom base_scan base_pose_ground_truth tf clock", "cmd_vel", "reset_positions"),
    "teleop_node": make_interface("cmd_vel", "joy"),
    "teleop_twist_joy": make_interface("cmd_vel", "joy"),
    "teleop_twist_keyboard": make_interface("cmd_vel"),
    "teleop_twist_keyboard.py": make_interface("cmd_vel"),
    "twist_mux": make_interface("cmd_vel_out", ""),
    "urg_node": make_interface("scan"),
    "usb_cam_node": make_interface("~image_raw ~camera_info", "", "~start_capture ~stop_capture"),
    "velocity_smoother": make_interface("smooth_cmd_vel", "raw_cmd_vel odometry robot_cmd_vel"),
}


def find_interface(executable: str, package: str = "") -> Interface | None:
    """Look up the interface of an executable, of a package if that is given; None for an unknown one."""
    own = LIBRARY_NODES.get(executable) if package == "ubiquity_launches" else None
    return own or KNOWN_NODES.get(executable)
