"""A motor from readings on a test bench, or from its data sheet (section 5.4)."""
