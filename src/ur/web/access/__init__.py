"""Decisions about who may do what: roles, tokens, sessions, hosts and origins, rates. No I/O."""
