"""Estimates of a map of fiducials, and of the robot's place on one, from observations and odometry."""
