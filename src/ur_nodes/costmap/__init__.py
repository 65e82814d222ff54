"""Costmaps from the map, scans and sonars, with the footprint of the robot."""
