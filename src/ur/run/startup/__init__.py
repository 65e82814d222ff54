"""The start of a run: selection of nodes, their computers, readiness and progress."""
