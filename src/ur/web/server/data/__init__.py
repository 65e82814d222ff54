"""Data of the robot for pages: web sockets, and the process that reads the data."""
