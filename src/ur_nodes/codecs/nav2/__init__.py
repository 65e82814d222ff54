"""Services of Nav2 and slam_toolbox, where their messages are installed."""
