"""A robot for programs of users: `Robot`, `AsyncRobot`, and the errors of their requests."""
