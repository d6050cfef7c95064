"""The derivative-free answer."""
