"""Robots that announce themselves, that were seen before, and that were set up from this computer."""
