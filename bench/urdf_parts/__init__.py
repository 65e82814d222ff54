"""The parts of bench/urdf."""
