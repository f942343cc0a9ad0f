"""The solids that meet: cutters, blades, blanks, the probe."""
