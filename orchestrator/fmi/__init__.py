"""What an FMU is: its archive, its description, its instances."""
