"""Inspect two computers from both ends, and report what keeps ROS from working between them."""
