"""Writers: they take results and return files, and recompute nothing."""
