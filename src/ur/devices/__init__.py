"""Devices of a computer: connected hardware, its probable type, its permissions, and the programs that use it."""
