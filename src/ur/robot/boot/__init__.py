"""Programs and the master that a robot starts when it boots, as systemd units."""
