"""Obstacle stop: slows and stops manual driving before obstacles that the base's sensors see."""
