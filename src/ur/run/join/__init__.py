"""Runs that join others at the same master: running nodes are used, and replaced only on request."""
