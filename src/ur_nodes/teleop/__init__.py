"""Driving by hand and by goal, from a terminal."""
