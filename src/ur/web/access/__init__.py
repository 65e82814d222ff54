"""Access control: roles, tokens, sessions, hosts and origins, rate limits. No I/O."""
