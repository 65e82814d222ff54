"""ROS nodes of our own: thin rospy shells (`node.py`) over pure, ROS-free modules."""
