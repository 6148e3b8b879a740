"""What the best filter could see: it knows what is hidden, and the sensor without it."""
