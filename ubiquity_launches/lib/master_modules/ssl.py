"""In place of the module of this name in a ROS master that `ur` starts: a master has no use for 1 MB of encryption."""

raise ImportError(__doc__)
