"""Pages: what a study has found as one HTML file that needs nothing but itself."""
