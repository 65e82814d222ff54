"""Packages that launch files need: found, planned, installed and removed again."""
