"""What effects change in a recording, and the directions in which each shape moves it."""
