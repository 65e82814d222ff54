"""Runs that two computers share: a robot's share of a program, its clients, and the lease of the robot."""
