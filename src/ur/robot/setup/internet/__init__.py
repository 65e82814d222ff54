"""Shared internet access: this computer's connection to package servers, for a robot without internet access."""
