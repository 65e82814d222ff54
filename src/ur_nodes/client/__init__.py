"""Drive and show a robot: what the terminal, the page, scripts and users' programs share.

Reads give frozen values and may come from any thread. Requests are made on the node's thread, unless they say that any
thread may make them.
"""
