"""Velocity commands between the commanders and the base: the mux, the limits of the base, and a velocity smoother."""
