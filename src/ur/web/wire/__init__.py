"""Messages between the robot's process, the server and the page: binary frames for display, JSON for requests."""
