"""Tables of parts: files, schemas, catalogues, conditions."""
