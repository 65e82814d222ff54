"""Devices of a simulated robot on pseudo-terminals, for real drivers, with which they share no code."""
