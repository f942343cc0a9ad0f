"""Virtual milling: what the cutter leaves of the metal."""
