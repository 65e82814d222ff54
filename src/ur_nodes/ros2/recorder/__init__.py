"""Recording of topics of any type on ROS 2."""
