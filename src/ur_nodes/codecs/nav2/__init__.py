"""Services of Nav2, where their messages are installed."""
