"""ROS 2 of a computer: its installations, its running processes, and their graph."""
