"""What leaves the house: C from Kernels, and the folders that carry it."""
