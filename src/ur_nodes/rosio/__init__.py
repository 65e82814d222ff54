"""Common parts of all nodes: start, parameters with exact errors, conversion of messages to and from arrays."""
