"""Processes of a run: commands, the process host, the terminal, and detached runs."""
