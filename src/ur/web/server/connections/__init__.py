"""Connections before the HTTP server: accepted, distinguished, limited, and handed on."""
