"""Expansion of xacro files, in a process that can only compute."""
