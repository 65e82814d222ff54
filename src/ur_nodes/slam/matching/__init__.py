"""Scans as pieces of surface, and their place on what was seen before."""
