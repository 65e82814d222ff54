"""The last two minutes of all topics, in memory, written to a file when something happens."""
