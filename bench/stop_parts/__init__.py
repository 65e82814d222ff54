"""Parts of bench/stop: a robot, those who drive it, and how each of them is lost."""
