"""keyboard_drive: velocities from keys."""
