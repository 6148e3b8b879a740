"""What reports share: the look of figures, and words for a camera."""
