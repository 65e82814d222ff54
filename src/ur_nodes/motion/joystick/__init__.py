"""Joysticks: the device, its origin, and the velocity commands that follow from it."""
