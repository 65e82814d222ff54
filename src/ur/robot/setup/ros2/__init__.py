"""Set-up of robots that already have ROS 2."""
