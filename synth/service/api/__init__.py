"""The routes of the interface: what may be asked over HTTP, and how it is answered."""
