"""Devices that log in: sessions, their file, their list, and the routes for them."""
