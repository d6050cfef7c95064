"""A robot along its path: when its recorded move began, what swung after it, what moves tell."""
