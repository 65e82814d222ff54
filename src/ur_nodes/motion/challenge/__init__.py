"""Challenges of a mux and the answers to them, which bound the age of velocity commands and requests."""
