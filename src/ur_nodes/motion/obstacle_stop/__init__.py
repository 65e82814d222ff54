"""Obstacle stop: velocities of people slowed and stopped by what the sensors of the base see."""
