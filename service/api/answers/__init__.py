"""What the service answers: typed, so that the OpenAPI document is complete."""
