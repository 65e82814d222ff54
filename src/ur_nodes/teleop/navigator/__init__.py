"""A robot that is sent to places."""
