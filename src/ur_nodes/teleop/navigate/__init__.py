"""keyboard_navigate: commands, map and waypoints on a terminal or a pipe."""
