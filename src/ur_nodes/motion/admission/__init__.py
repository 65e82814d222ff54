"""Admission of velocity commands, locks and lease requests to a mux, and reports of those that it drops."""
