"""Looking through the store for what is missing, altered or left over; nothing is ever changed."""
