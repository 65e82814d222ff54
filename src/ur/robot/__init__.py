"""Robots and their bases: descriptions, discovery, connections, set-up and diagnosis."""
