"""The parts of bench/fiducials."""
