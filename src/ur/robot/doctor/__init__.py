"""Looks at two computers from both ends and says what keeps ROS from working between them."""
