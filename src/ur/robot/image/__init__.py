"""Images of operating systems: their content, and the seed for a robot's first boot."""
