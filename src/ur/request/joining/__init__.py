"""Launches beside running nodes, and robots that another client drives."""
