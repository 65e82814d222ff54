"""Commands that start programs and launch files."""
