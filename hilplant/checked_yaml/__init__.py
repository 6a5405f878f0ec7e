"""YAML files with the line of every key, checked against typed descriptions."""
