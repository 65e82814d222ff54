"""Monitoring of the link between this computer and a robot: signal, latency and packet loss, second by second."""
