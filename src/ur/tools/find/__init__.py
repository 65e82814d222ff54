"""Definitions and uses of names in launch files, over a whole workspace."""
