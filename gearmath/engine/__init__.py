"""How a CasADi function is run on many points: compiled for this computer and cached, else by the virtual machine."""
