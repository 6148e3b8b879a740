"""Plans: what to measure, in which order, and under which conditions to go on."""
