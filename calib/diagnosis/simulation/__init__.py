"""What effects change, simulated about the fitted baseline with few exact lines."""
