"""What is expected of a run, and whether it held: conditions over signals and frames, judged on every tick."""
