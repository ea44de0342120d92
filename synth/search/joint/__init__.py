"""Joint search: questions that differ in numbers alone, searched as one tree (multi-parametric branch and bound)."""
