"""Velocity control of the wiper by its supply voltage, and estimation of its speed without a sensor."""
