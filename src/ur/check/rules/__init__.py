"""The rules: each file here is one, with its page, its examples and, where it looks for itself, its hook."""
