"""What is exported: C from Kernels, and the folders that carry it."""
