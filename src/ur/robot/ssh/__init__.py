"""Running commands on this computer and on others, over the OpenSSH client."""
