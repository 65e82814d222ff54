"""Maps as files and topics: the stand-in for `map_server`."""
