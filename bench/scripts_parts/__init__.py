"""Parts of bench/scripts: scripts that are lost while they drive, and a node that sees what the robot does."""
