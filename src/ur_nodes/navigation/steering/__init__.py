"""Motion along a path: variants simulated ahead, speeds, recovery."""
