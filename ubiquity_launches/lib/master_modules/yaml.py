"""In place of the module of this name in a ROS master that `ur` starts: its log configuration is no YAML (1 MB)."""
