"""Commands on workspaces of robots: synchronise, build, and mount."""
