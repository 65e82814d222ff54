"""The set-up of robots that have ROS 2 already."""
