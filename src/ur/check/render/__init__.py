"""Output formats of a check: text, JSON, GitHub commands, and the pages of the rules."""
