"""Bringing a computer to a wanted state: what is there (facts), what is wanted, and the changes between the two."""
