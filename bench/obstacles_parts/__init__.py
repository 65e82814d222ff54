"""The parts of bench/obstacles."""
