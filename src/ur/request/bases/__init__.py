"""The base of a robot: its known properties, and the needs of launch files."""
