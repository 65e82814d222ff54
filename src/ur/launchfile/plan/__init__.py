"""Tree + world + arguments -> Plan."""
