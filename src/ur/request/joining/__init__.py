"""Launches beside nodes that run, and robots that another client drives."""
