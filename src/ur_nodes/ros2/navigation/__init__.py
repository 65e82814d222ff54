"""Interfaces of Nav2 besides topics: its actions, where its messages are installed, and the states of its nodes."""
