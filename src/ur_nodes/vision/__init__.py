"""Fiducials: detection in pictures, mapping, and localisation."""
