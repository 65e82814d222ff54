"""Lidars: a module each has the protocol (bytes in, values out; no I/O and no clock) and a stand-in of the device."""
