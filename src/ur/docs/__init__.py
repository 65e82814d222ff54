"""Documents of a launch repository, made from its resolved launch files: collect, resolve, describe, render."""
