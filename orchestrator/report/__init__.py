"""Pages: the findings of a study as one HTML file that needs no other file."""
