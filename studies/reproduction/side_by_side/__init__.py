"""Every system on the same moves: what each takes (`results`), as tables and as a picture."""
