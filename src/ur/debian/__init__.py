"""The Debian root in which `ur` runs on a release that has no ROS 1."""
