"""The documents as a static site that needs no network and no server."""
