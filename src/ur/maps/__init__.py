"""Stored maps: folders with a map's picture, and the scans and the pose graph from which it was drawn."""
