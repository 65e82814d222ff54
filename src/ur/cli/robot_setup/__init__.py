"""Commands that set robots up and change them: setup, rename, wifi, network and images."""
