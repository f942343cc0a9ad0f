"""Plans as text of NC programs."""
