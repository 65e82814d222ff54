"""The black box: the last two minutes of all topics in memory, written to a file after an event."""
