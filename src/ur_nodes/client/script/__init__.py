"""A robot for programs of users: `Robot`, and the errors of their requests."""
