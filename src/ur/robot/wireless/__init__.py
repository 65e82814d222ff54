"""Watches the way between this computer and a robot: signal, latency and loss, second by second."""
