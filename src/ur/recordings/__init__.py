"""Recordings of topics on this computer."""
