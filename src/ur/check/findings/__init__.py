"""Findings after the rules: merged over cases, hidden by comments, fixed in the text."""
