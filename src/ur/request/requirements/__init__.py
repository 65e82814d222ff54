"""Packages and files that programs need, installed or checked before the start."""
