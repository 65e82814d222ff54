"""Packages, files and environment, behind one Protocol."""
