"""Images of operating systems: what is in them, and the seed from which a robot's first boot grows."""
