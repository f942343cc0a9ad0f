"""Bevel members: places on the blank and the tooth surfaces that settings cut."""
