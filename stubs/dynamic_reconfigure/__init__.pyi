"""Made by tools/make_message_stubs.py. Do not edit."""
