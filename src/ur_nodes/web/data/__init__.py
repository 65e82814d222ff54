"""Topics, diagnostics and 3D of the robot for pages: a process apart from the one that drives."""
