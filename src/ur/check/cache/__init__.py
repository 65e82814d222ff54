"""Findings of earlier checks, stored with every query that they depend on; see docs/how-to/check.md."""
