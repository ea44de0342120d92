"""The pages: what a person sees of the service in a browser. They know nothing that the interface does not tell."""
