"""Runs that join others at the same master: nodes that run already are used, and no node is replaced unasked."""
