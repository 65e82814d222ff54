"""The terminal of a program: keys, screen, and a node that owns it."""
