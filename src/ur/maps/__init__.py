"""Stored maps: folders that hold a map's picture beside the scans and the pose graph that it was drawn from."""
