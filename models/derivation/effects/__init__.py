"""One file per effect: what the sensors or the reference report beyond the truth."""
