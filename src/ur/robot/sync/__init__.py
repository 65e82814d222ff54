"""Synchronisation of the workspaces on this computer and on a robot, in both directions, without losing a change."""
