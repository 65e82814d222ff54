"""The middleware that connects the nodes of a run: a master of ROS 1, or the graph of a domain of ROS 2."""
