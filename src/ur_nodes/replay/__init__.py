"""Replay of recordings: their messages are published again, at any speed."""
