"""The map as terminal cells."""
