"""What is raised where a quantity or an expression cannot be what was asked for; it is the InputError of gearmath."""


class InputError(ValueError):
    """Bad input. The message is one sentence that names the file, the key, the value and the limit (exit status 2)."""
