"""Additions to the topics of upstream's drivers of real bases."""
