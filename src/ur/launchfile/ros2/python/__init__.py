"""Python launch files, read without running them: the values of their expressions, as far as they are certain."""
