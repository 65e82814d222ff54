"""Driving from pages: each request is checked, answered, and passed on."""
