"""Commands on robots: selection, shells, files, wireless link and boot services."""
