"""Compiled code, built when the package is installed: loading it, and threads that run it."""
