"""What asv times from one version to the next."""
