"""Workspaces here and on a robot, brought in step both ways without losing a change of either."""
