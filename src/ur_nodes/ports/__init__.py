"""Values, and the protocol that nodes are written against, independent of any middleware."""
