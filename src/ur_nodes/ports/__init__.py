"""Values, and the protocol that nodes are written against. No middleware is named here."""
