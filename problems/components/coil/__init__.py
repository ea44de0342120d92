"""Coil of an electromagnet: winding, heat, supply, and its curves over current and temperature."""
