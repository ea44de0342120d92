"""Compiled code: finding the compiler, keeping what it built."""
