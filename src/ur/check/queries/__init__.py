"""Queries of rules about packages, programs, comments and YAML files."""
