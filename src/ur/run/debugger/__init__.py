"""Debuggers for nodes: selection, terminals, core dumps, and attaching to a running node."""
