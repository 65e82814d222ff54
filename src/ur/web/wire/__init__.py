"""Messages between the robot's end, the server and the page: binary frames to look at, JSON for requests."""
