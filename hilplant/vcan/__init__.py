"""A private vcan0, where the kernel has none in User Mode Linux."""
