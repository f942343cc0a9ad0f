"""What a control makes of the text of a program; shares nothing with the writers."""
