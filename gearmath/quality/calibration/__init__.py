"""Tip of the probe, and rotary axes, from touches on artefacts."""
