"""The modelling tool: a wiper described, seen, checked, identified and made into a bench."""
