"""Packages that launch files need: search, plan, installation and removal."""
