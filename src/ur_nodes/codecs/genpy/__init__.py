"""Messages of ROS 1, made and read without lists of Python numbers."""
