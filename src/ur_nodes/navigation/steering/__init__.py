"""Motion along a path: simulated variants, speeds, recovery."""
