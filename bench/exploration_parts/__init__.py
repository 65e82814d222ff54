"""The parts of bench/exploration."""
