"""The electronic gearbox: what a job needs (train), what a rule does over time (simulation), why it holds (proof)."""
