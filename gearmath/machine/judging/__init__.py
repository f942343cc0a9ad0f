"""Whether a machine may run a program, and whether the part is right."""
