"""What those see who watch the service: metrics, and its log."""
