"""Inertial units on I2C: a module each, which knows its registers."""
