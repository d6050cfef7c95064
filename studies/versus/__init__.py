"""A plan against what is used today: shapers, and time-optimal profiles. May import `display`."""
