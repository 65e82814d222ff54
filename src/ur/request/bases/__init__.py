"""The base of a robot: known facts, and the needs of launch files."""
