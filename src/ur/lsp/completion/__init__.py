"""Completion: in launch files, YAML files and programs."""
