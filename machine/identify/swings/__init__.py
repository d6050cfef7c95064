"""The parts of a recording that swing freely: where they are, and how they change."""
