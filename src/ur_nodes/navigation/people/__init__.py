"""People round the robot: tracked from scans, and predicted."""
