"""The HTTP server: routes, web sockets, and the process that talks to ROS."""
