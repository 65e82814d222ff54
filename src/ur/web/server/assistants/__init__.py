"""Assistants on the page and over HTTP: addresses for them, their grants, and the requests that they send."""
