"""Launch files of ROS 1 as launch files of ROS 2, in XML."""
