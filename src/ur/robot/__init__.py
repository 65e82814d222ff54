"""Robots and their bases: what they are, where they are, how they are set up."""
