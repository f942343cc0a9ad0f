"""A simulated control: an OPC UA server as a SINUMERIK 840D sl has it, with the machine model behind it."""
