"""``halltwin lab``: the twin as a local page; a server for one person, and what it computes for the page."""
