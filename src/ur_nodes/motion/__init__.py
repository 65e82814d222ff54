"""Velocity commands between the commanders and the base: the mux, and the limits of the base."""
