"""Clients of a run: the protocol of its socket, subscribers, and the client itself."""
