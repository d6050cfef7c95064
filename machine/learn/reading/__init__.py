"""Reading of one recording: when the move began in it, and what swung after the move."""
