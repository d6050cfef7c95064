"""Benchmarks that asv times from one version to the next."""
