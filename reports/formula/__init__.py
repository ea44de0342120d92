"""Formulas for people: one layout of a tree, written as MathML, as Typst, or as plain text."""
