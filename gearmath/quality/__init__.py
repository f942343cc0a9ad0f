"""From measured points to what is wrong with a gear, and to the settings that correct it."""
