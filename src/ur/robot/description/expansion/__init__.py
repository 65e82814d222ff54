"""Expansion of xacro files, in a process that computes and can do nothing else."""
