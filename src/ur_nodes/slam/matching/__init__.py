"""Scans as pieces of surface, and their matching to earlier ones."""
