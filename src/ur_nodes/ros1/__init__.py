"""ROS 1: rospy behind the protocol of `ur_nodes.ports`, and the messages of its values."""
