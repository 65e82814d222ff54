"""Repairs of rospy: connections that end, memory that it keeps, threads and log files that fail."""
