"""Parts of bench/stop_network: booted computers, their programs, and what goes wrong with them."""
