"""Lint checks for launch files, YAML files and programs: the rules, and the engine that applies them."""
