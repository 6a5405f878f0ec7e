"""What `hilplant perf` measures, one file for each part; nothing here is imported by a running plant."""
