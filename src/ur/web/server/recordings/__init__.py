"""Recordings of topics that pages start: one process, its limits, and its files."""
