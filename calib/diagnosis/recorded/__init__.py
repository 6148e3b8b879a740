"""What a recording says of itself: sensor, conditions, light that is known."""
