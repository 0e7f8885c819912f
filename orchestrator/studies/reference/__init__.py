"""Solutions that other runs are held against."""
