"""Inspection of two computers from both ends, to report what prevents ROS from working between them."""
