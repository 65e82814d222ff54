"""In place of the module of this name in a ROS master that `ur` starts: it makes no help pages (1 MB)."""

HTMLDoc = object
