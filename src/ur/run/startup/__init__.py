"""The start of a run: selection of nodes, their computers, readiness, progress and timings."""
