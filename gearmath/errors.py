"""Two kinds of errors: input that a person can correct, and work that failed."""


class InputError(ValueError):
    """Bad input. The message is one sentence that names the file, the key, the value and the limit (exit status 2)."""


class ComputationError(RuntimeError):
    """Work that failed on good input: an iteration did not converge, a compiler is missing (exit status 1)."""
