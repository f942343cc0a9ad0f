"""What arguments of public functions may be, and the check of them; :mod:`gearmath.arguments.known` is the table."""
