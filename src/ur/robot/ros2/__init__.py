"""ROS 2 on a computer: its installations, its running processes, and their graph."""
