"""Function generator, high-voltage amplifier and RC electrodes, two channels."""
