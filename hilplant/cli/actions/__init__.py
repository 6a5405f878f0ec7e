"""What each command does: it calls the rooms and prints what they return; imported when the command runs."""
