"""Nodes of our own: wiring (`*_node.py`) over pure modules, for ROS 1, ROS 2 and one process (`memory`)."""
