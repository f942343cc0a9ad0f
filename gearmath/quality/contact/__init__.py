"""Contact of measured flanks: surfaces of them, the pair, and how sure its pattern is."""
