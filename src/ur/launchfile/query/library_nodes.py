"""Topics, services and actions of this library's nodes. Made by tools/make_known_nodes.py."""

from ur.launchfile.query.arguments import Interface, make_interface

LIBRARY_NODES: dict[str, Interface] = {
    "amcl": make_interface(
        publishes="amcl_pose particlecloud ~lost tf",
        subscribes="scan initialpose map tf",
        services="global_localization request_nomotion_update set_map",
        calls="static_map",
    ),
    "base_driver": make_interface(publishes="odom joint_states tf", subscribes="cmd_vel"),
    "black_box": make_interface(
        subscribes="cmd_vel_mux/stopped cmd_vel_mux/lease amcl/lost move_base/status", services="~write"
    ),
    "calibrate_camera": make_interface(
        subscribes="raspicam_node/image/compressed", calls="raspicam_node/set_camera_info"
    ),
    "twist_mux": make_interface(
        publishes="cmd_vel_out ~challenge ~active ~stopped ~lease ~obstacle_stop diagnostics",
        subscribes="joy_vel joy_vel_stamped key_vel key_vel_stamped web_vel web_vel_stamped nav_vel "
        "nav_vel_stamped pause_driving ~lease_request odom scan sonars",
        services="~stop ~release ~set_obstacle_stop",
    ),
    "depthimage_to_laserscan": make_interface(publishes="scan", subscribes="image camera_info"),
    "driver_adapter": make_interface(publishes="joint_states", subscribes="odom driver/scan driver/bumpers"),
    "explore": make_interface(
        publishes="~status ~frontiers",
        subscribes="map tf move_base/global_costmap/costmap move_base/global_costmap/costmap_updates "
        "cmd_vel_mux/stopped cmd_vel_mux/active cmd_vel_mux/lease",
        uses="move_base",
    ),
    "explore_progress": make_interface(subscribes="status"),
    "aruco_detect": make_interface(
        publishes="fiducial_vertices fiducial_transforms fiducial_images tf",
        subscribes="camera/compressed camera_info ignore_fiducials",
    ),
    "fiducial_slam": make_interface(
        publishes="fiducials fiducial_map fiducial_pose tf",
        subscribes="fiducial_vertices camera_info tf initialpose",
        services="clear_map save_map global_localization",
    ),
    "republish": make_interface(publishes="out", subscribes="in"),
    "imu_driver": make_interface(publishes="imu/data"),
    "joy_node": make_interface(publishes="joy", subscribes="joy/set_feedback"),
    "keyboard_navigate_node": make_interface(
        publishes="initialpose move_base/continue patrol/request cmd_vel_mux/lease_request",
        subscribes="map scan tf amcl_pose amcl/lost move_base/hold patrol/status cmd_vel_mux/stopped "
        "cmd_vel_mux/active cmd_vel_mux/lease cmd_vel_mux/challenge",
        uses="move_base",
    ),
    "lidar_driver": make_interface(publishes="scan"),
    "costmap_2d_node": make_interface(publishes="~costmap/costmap ~costmap/footprint", subscribes="scan sonars tf"),
    "map_saver": make_interface(subscribes="map"),
    "map_server": make_interface(
        publishes="map map_metadata zones walls keepout_filter_mask speed_filter_mask",
        subscribes="zone_request wall_request",
        services="static_map change_map",
    ),
    "move_base": make_interface(
        publishes="cmd_vel cmd_vel_stamped ~current_goal ~global_costmap/costmap "
        "~global_costmap/costmap_updates ~local_costmap/costmap ~hold",
        subscribes="map odom scan tf move_base_simple/goal amcl/lost cmd_vel_mux/stopped cmd_vel_mux/lease "
        "cmd_vel_mux/challenge cmd_vel_mux/speed_limit_in_force cmd_vel_mux/active imu/data",
        services="~make_plan ~clear_costmaps",
        actions="move_base",
    ),
    "patrol": make_interface(
        publishes="~status cmd_vel_mux/lease_request",
        subscribes="~request map tf cmd_vel_mux/stopped cmd_vel_mux/lease cmd_vel_mux/challenge",
        uses="move_base",
    ),
    "raspicam_node": make_interface(
        publishes="~image/compressed ~image ~camera_info", services="~set_camera_info ~stop_capture ~start_capture"
    ),
    "replay": make_interface(publishes="clock"),
    "robot_state_publisher": make_interface(publishes="tf tf_static", subscribes="joint_states"),
    "simulator": make_interface(
        publishes="odom base_pose_ground_truth joint_states tf ~collisions",
        subscribes="cmd_vel",
        services="~pause ~step ~reset ~place",
    ),
    "slam_gmapping": make_interface(
        publishes="map map_metadata ~entropy tf", subscribes="scan imu tf", services="dynamic_map ~save"
    ),
    "sonar_driver": make_interface(publishes="sonars"),
    "teleop_node": make_interface(
        publishes="cmd_vel_stamped cmd_vel_mux/lease_request",
        subscribes="joy cmd_vel_mux/challenge cmd_vel_mux/lease",
        calls="cmd_vel_mux/stop cmd_vel_mux/release",
    ),
    "teleop_twist_keyboard.py": make_interface(
        publishes="cmd_vel_stamped cmd_vel_mux/lease_request",
        subscribes="cmd_vel_mux/active cmd_vel_mux/challenge cmd_vel_mux/lease cmd_vel_mux/obstacle_stop "
        "cmd_vel_mux/stopped",
        calls="cmd_vel_mux/stop cmd_vel_mux/release cmd_vel_mux/set_obstacle_stop",
    ),
    "velocity_smoother": make_interface(publishes="smooth_cmd_vel", subscribes="raw_cmd_vel odometry robot_cmd_vel"),
}
