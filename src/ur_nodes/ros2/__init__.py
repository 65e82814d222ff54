"""The backend for ROS 2: `ports` on rclpy."""
