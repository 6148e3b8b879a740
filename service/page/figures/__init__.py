"""Figures that one can zoom: each a function from values to what Plotly draws."""
