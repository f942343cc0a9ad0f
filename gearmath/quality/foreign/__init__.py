"""Points of other measuring machines."""
