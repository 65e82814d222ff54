"""Nodes in one process without any middleware: a deterministic bus, and a clock that jumps from event to event."""
