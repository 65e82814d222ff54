"""Output formats of a check: text, JSON, SARIF, GitHub commands, and the pages of the rules."""
