"""The parts of the node `slam_gmapping`."""
