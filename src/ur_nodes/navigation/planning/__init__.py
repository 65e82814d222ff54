"""Paths on a costmap: search from cell to cell, straight lines and smooth turns, and the geometry of polylines."""
