"""Commands on workspaces of robots: synchronised, built, and mounted here."""
