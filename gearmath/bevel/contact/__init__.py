"""Exact contact of a pair: where its flanks touch, edges and corners included, and how the gear follows the pinion."""
