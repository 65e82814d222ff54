"""Connections before the HTTP server: accepted, classified, limited, and handed over."""
