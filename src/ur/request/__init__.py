"""Requests to launch files and programs: arguments, selection, requirements, and where nodes run."""
