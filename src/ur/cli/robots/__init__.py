"""Commands on robots: selection, shells, devices, wireless link and boot services."""
