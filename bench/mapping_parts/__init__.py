"""The parts of bench/mapping."""
