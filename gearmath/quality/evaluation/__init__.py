"""From touches to figures: what was measured, judged as a metrologist does."""
