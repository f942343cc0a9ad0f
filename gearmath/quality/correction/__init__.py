"""From deviations to corrected settings."""
