"""The forward model: light becomes DN through a chain of effects, written once."""
