"""The line between a driver and its device: its shape, a serial one, and the guard that stops motors."""
