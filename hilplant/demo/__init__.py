"""A demonstration that needs no CAN in the kernel and no privileges: plant and ECU on an in-memory bus."""
