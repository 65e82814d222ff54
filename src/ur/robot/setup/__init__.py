"""Bringing a computer to a desired state: its facts, the wanted state, and the changes between the two."""
