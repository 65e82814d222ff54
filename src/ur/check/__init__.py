"""Checking launch files, YAML files and programs: rules, one file each, and what runs them."""
