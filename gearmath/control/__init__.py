"""The machine control: what any control offers, SINUMERIK over OPC UA, a simulated control, the measurement store."""
