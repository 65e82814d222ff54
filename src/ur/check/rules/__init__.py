"""The rules in groups: each module has `RULES`, their examples, and their functions."""
