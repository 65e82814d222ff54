"""Nodes and services on the selected robot, over ssh and its ROS master."""
