"""What the pages in a browser share: a local server with a token, its limits, and the look."""
