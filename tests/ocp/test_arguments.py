"""What every function asks of its arguments first."""
