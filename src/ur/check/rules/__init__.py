"""The rules in groups: each module has `RULES`, their examples, and the functions that find what they report."""
