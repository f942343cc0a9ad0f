"""How sure figures and settings are."""
