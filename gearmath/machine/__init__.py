"""The vertical milling machine: axis positions, NC programs written and read back, virtual milling."""
