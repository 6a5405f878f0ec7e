"""The stand-in body ECU: a relay controller, and the CAN node that uses it."""
