"""Maps from lidar scans: the stand-in for `gmapping`."""
