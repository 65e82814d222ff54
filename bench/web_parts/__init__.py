"""Parts of bench/web: a bad link, pages that drive over it, a plain bridge as peer, and a record of what happened."""
