"""The simulated machine with its probe: programs run, touches made."""
