"""Machine settings from deviations of flanks: the root finder, the step, the variables."""
