"""The gear that the electronic gearbox cuts, gash by gash, and its inspection."""
