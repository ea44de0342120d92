"""What differs between operating systems, and how processes wait, lock and are interrupted."""
