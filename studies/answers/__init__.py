"""What is read: answers in files, judged anew, coefficients of others, and names of profiles."""
