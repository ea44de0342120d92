"""Calculation sheets: what they say as neutral blocks, and the blocks as HTML, PDF and JSON."""
