"""This project, and catkin workspaces, on a robot: copied and built."""
