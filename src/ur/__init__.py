"""The `ur` command: launch files, robots and programs on ROS 1. Imports no ROS Python."""
