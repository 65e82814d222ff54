"""Requests: from command-line arguments and the selection to a launch file's plan, with its requirements and hosts."""
