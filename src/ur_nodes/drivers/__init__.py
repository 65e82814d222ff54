"""Drivers of real bases, lidars, sonars and inertial units, and additions to the topics of upstream's drivers."""
