"""Recordings of topics that pages start: one process, its limits, and the files that it leaves."""
