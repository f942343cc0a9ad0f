"""What is to be done: paths, blocks, passes, touches; no words of a control."""
