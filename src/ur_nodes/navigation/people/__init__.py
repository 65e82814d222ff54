"""People around the robot: tracked in scans, and predicted."""
