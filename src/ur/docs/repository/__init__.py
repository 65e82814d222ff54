"""The contents of a launch repository, each file read once."""
