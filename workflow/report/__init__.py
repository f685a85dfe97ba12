"""The page of a scene: what each stage found, and how far to trust it."""
