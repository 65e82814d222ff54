"""All nodes of a run in one process, in real time, where no ROS is installed."""
