"""The meaning of each tag of a launch file."""
