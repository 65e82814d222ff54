"""Fiducials: found in pictures, mapped, and used to know where the robot is."""
