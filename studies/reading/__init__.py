"""What is read from files: answers, judged anew, and coefficients that another program found."""
