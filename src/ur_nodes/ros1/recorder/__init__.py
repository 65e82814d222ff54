"""A recorder of topics of ROS 1: all connections on one thread, which reads what has arrived a few times a second."""
