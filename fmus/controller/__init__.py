"""Digital controller: drives at resonance and holds a stroke."""
