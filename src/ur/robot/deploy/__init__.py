"""Copying and building this project, and catkin workspaces, on a robot."""
