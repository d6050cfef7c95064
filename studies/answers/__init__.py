"""Answers that are read: from files, judged anew, coefficients of others, names of profiles."""
