"""What a fit or an identification leaves behind for people: a page with its figures, tables and pictures."""
