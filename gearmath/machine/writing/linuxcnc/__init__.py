"""Programs in the dialect of LinuxCNC: RS-274 words, numbered O-words, parameters, probing with G38."""
