"""Nodes of our own: wiring (`*_node.py`) over pure modules, written against `ports`; `ros1` runs them on ROS."""
