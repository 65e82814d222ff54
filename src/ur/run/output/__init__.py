"""Output of nodes and reports of the run: log files, the console, messages."""
