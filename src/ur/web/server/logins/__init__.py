"""Logins of devices: sessions, their file, their list, and their routes."""
