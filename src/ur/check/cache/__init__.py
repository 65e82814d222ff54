"""Findings of earlier checks, kept with every question that they depend on; see docs/how-to/check.md."""
