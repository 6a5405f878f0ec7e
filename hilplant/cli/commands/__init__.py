"""The commands: a file each, or a folder for a group; found by themselves, so a new file is a new command."""
