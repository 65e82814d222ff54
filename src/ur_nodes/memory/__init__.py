"""Nodes in one process without any middleware: a bus, a clock that jumps from event to event, and no chance."""
