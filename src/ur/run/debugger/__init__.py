"""Debuggers for nodes: which one, in which terminal, core dumps, and attaching to a running node."""
