"""Pictures of real cameras: USB cameras and others by V4L2, the cameras of a Raspberry Pi by libcamera."""
