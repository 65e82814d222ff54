"""The start of a run: nodes to start, their computers, readiness, progress and timings."""
