"""Stored maps of the mapper: scans and pose graph to the files of `ur.maps` and back."""
