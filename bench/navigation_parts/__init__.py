"""The parts of bench/navigation."""
