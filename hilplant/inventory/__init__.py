"""The library of section 8.2: what is shipped, by kind, with source and status."""
