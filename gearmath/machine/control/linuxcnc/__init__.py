"""Programs for LinuxCNC, read and run as its interpreter would: the words that programs of this package have."""
