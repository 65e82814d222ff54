"""The test of wheels off the ground: `ur robot wheels`."""
