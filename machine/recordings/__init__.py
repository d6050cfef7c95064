"""Recordings as arrays: times, glitches, noise, envelopes and spectra."""
