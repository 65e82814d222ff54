"""Tools for launch files beside their checks and documents: find, format, new, package."""
