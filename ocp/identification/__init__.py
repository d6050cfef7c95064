"""A plant's parameters from recordings of the machine."""
