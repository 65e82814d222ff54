"""Sonars: HC-SR04 on the pins of a Raspberry Pi, and distances as messages."""
