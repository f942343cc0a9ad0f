"""Design of a pair: from a few data to blank and settings of both members, and to how the pair runs."""
