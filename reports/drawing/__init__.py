"""Drawings on paper: one layout, written as SVG and as DXF."""
