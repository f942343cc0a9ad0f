"""Files that other programs read: each a module, without what computes."""
