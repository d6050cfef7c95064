"""What a contest shows: tables, pictures, references and the page."""
