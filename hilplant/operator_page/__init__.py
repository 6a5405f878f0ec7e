"""The operator's page: see a run or a recording, drive it by hand, log it, from a browser."""
