"""Commands on this computer: setup, env, doctor and completion."""
