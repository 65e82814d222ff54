"""Connections before the HTTP server: accepted, told apart, limited, and handed on."""
