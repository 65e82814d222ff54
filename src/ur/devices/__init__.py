"""Devices of a computer: what is plugged in, what it probably is, who may open it and who has it open."""
