"""Further tools for launch files: find, format, new, package."""
