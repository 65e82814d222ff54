"""Exploration: where a map that grows ends, the order of the places to look from, and why the exploration ends."""
