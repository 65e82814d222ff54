"""Maps as files and topics: the stand-ins for `map_server` and `map_saver`."""
