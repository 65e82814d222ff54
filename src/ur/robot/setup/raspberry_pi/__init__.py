"""Settings of a Raspberry Pi for a base whose board is on its header."""
